// Keeps drivers and layers loaded in programs with the address sanitizer. If they were unloaded before leaks
// are reported, they would be unknown modules in the stacks, which no suppression can name.
extern "C" int dlclose(void* /*handle*/) {
  return 0;
}

// Linked into programs with the address sanitizer: drivers and layers that are unloaded before leaks are
// looked for would be unknown modules in their stacks, which no suppression can name.
extern "C" int dlclose(void* /*handle*/) {
  return 0;
}

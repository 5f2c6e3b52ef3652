// Words in ATTACHMENTS attachments of four words each. The fragments of a pixel run one after the other in
// draw order and read what the one before left (rasterization order attachment access). main() begins with
// EACH(LOAD) and ends with EACH(STORE).
#define ATTACHMENT(i) \
  layout(input_attachment_index = i, set = 1, binding = i) uniform usubpassInput before_##i; \
  layout(location = i) out uvec4 after_##i;
#define SLOTS (4u * ATTACHMENTS / 3u)
uint words[4 * ATTACHMENTS];
#define LOAD(i) { \
    const uvec4 four = subpassLoad(before_##i); \
    words[4 * i] = four.x; words[4 * i + 1] = four.y; words[4 * i + 2] = four.z; words[4 * i + 3] = four.w; }
#define STORE(i) after_##i = uvec4(words[4 * i], words[4 * i + 1], words[4 * i + 2], words[4 * i + 3]);
uvec3 slot_at(uint i) { return uvec3(words[3u * i], words[3u * i + 1u], words[3u * i + 2u]); }
void put_slot(uint i, uvec3 f) {
  words[3u * i] = f.x;
  words[3u * i + 1u] = f.y;
  words[3u * i + 2u] = f.z;
}

#if ATTACHMENTS == 1
#define EACH(what) what(0)
#elif ATTACHMENTS == 2
#define EACH(what) what(0) what(1)
#elif ATTACHMENTS == 3
#define EACH(what) what(0) what(1) what(2)
#elif ATTACHMENTS == 4
#define EACH(what) what(0) what(1) what(2) what(3)
#elif ATTACHMENTS == 5
#define EACH(what) what(0) what(1) what(2) what(3) what(4)
#elif ATTACHMENTS == 6
#define EACH(what) what(0) what(1) what(2) what(3) what(4) what(5)
#elif ATTACHMENTS == 7
#define EACH(what) what(0) what(1) what(2) what(3) what(4) what(5) what(6)
#else
#define EACH(what) what(0) what(1) what(2) what(3) what(4) what(5) what(6) what(7)
#endif
EACH(ATTACHMENT)

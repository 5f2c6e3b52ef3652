// The key of a fragment: its depth bits, then its id, as one number. Smaller keys are nearer. No fragment has
// the key 0.
#ifndef KEYS_GLSL
#define KEYS_GLSL
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
const uint64_t kNoKey = ~uint64_t(0);
// Depths in 0..1 leave two bits free. In the last key of a round they say that its fragment was counted as
// coplanar, and that its pixel was.
const uint64_t kCountedFragment = uint64_t(1) << 63;
const uint64_t kCountedPixel = uint64_t(1) << 62;
const uint64_t kKeyBits = kCountedPixel - uint64_t(1);
uint64_t make_key(float z, uint id) { return (uint64_t(floatBitsToUint(z)) << 32) | uint64_t(id); }
uint key_id(uint64_t key) { return uint(key & uint64_t(0xFFFFFFFFu)); }
float key_depth(uint64_t key) { return uintBitsToFloat(uint(key >> 32)); }
#endif

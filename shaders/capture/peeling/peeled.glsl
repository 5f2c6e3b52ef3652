// The layer that the last round took, as the depth test left it, and whether a depth was peeled with it or
// before. Where that found nothing its depth is 1, the farthest there is: all is peeled.
layout(set = 0, binding = SLOT_IMAGE_0) uniform texture2D previous;
bool is_peeled(bool resumed) {
  if (push.round == 0u) return false;
  const float z = texelFetch(previous, ivec2(gl_FragCoord.xy), 0).x;
  return resumed ? gl_FragCoord.z != z : gl_FragCoord.z <= z;
}

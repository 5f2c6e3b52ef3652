// The layer that the last round took, as the depth test left it. is_peeled() returns whether the depth of
// this fragment was peeled in that round or before. If that round found nothing, the depth of its layer is 1,
// the farthest depth, so everything counts as peeled.
layout(set = 0, binding = SLOT_IMAGE_0) uniform texture2D previous;
bool is_peeled(bool resumed) {
  if (push.round == 0u) return false;
  const float z = texelFetch(previous, ivec2(gl_FragCoord.xy), 0).x;
  return resumed ? gl_FragCoord.z != z : gl_FragCoord.z <= z;
}

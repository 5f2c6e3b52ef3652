// What the tail of a pixel covers of what the fragments in front of it let through (E): a byte for the importance of
// the next frame, which grows where more than kWanted is left to the tail and shrinks elsewhere (terms.glsl).
#ifndef RESIDUE_GLSL
#define RESIDUE_GLSL
layout(std430, set = 0, binding = SLOT_E) buffer Residues { uint residues[]; };
const float kWanted = 1.0 / 16.0;
void measure_residue(uint pixel, float residue) {
  const uint shift = 8u * (pixel % 4u);
  const int old = int(residues[pixel / 4u] >> shift & 255u);
  const int step = int(round(16.0 * log2((residue + kWanted / 4.0) / (1.25 * kWanted))));
  const int now = clamp(old + step, 0, 255);
  atomicXor(residues[pixel / 4u], uint(old ^ now) << shift);
}
#endif

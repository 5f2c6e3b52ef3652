// Adds what a workgroup of 8 x 8 pixels captured to the counters once. Call begin_tally() first and
// end_tally() last, in uniform control flow.
#ifndef TALLY_GLSL
#define TALLY_GLSL
shared uint captured_sum, coplanar_sum, coplanar_pixels_sum, active_sum;

void begin_tally() {
  if (gl_LocalInvocationIndex == 0u) {
    captured_sum = 0u;
    coplanar_sum = 0u;
    coplanar_pixels_sum = 0u;
    active_sum = 0u;
  }
  barrier();
}

// `new_pixel`: no earlier round counted the pixel as one with coplanar fragments. `goes_on`: the next round
// may find more.
void tally(uint captured, uint coplanar, bool new_pixel, bool goes_on) {
  if (captured > 0u) atomicAdd(captured_sum, captured);
  if (goes_on) atomicAdd(active_sum, 1u);
  if (coplanar > 0u) {
    atomicAdd(coplanar_sum, coplanar);
    if (new_pixel) atomicAdd(coplanar_pixels_sum, 1u);
  }
}

void end_tally() {
  barrier();
  if (gl_LocalInvocationIndex != 0u) return;
  if (captured_sum > 0u) atomicAdd(counters.captured, captured_sum);
  if (active_sum > 0u) atomicAdd(counters.active_pixels, active_sum);
  if (coplanar_sum > 0u) {
    atomicAdd(counters.coplanar, coplanar_sum);
    atomicAdd(counters.coplanar_pixels, coplanar_pixels_sum);
  }
}
#endif

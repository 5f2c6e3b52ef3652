// Samples of a pixel. The band is drawn once for each sample, through a window that is moved by the position
// of the sample (Recorder). These copies lie below each other, and each sample is a pixel of its own until
// the image is averaged.
#ifndef SAMPLES_GLSL
#define SAMPLES_GLSL
// The standard positions of four samples (Vulkan), as in src/render/device/recorder.cpp.
const vec2 kSamplePlaces[4] = vec2[](vec2(0.375, 0.125), vec2(0.875, 0.375), vec2(0.125, 0.625), vec2(0.625, 0.875));

uint rows_of_band() { return frame.size.y / frame.samples; }

// Returns the position of a sample in the whole image, in pixels from its upper left corner.
vec2 place_in_image(uvec2 at) {
  const vec2 place = frame.samples == 1u ? vec2(0.5) : kSamplePlaces[at.y / rows_of_band()];
  return vec2(float(at.x), float(at.y % rows_of_band() + frame.first_row)) + place;
}
// Returns the number of a sample among those of the whole image, which does not depend on the band.
uint sample_in_image(uvec2 at) {
  const uint rows = uint(frame.line.w);
  const uint row = at.y / rows_of_band() * rows + at.y % rows_of_band() + frame.first_row;
  return row * frame.size.x + at.x;
}
vec2 image_size() { return vec2(float(frame.size.x), frame.line.w); }
#endif

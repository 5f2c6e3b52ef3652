// Which pixel a fragment belongs to or, with multisampling, which sample: samples are columns of a picture that is so
// many times as wide, and each is shaded by itself.
#ifndef SAMPLE_INDEX_GLSL
#define SAMPLE_INDEX_GLSL
uint fragment_pixel() {
  const uvec2 pixel = uvec2(gl_FragCoord.xy);
  return pixel_index(uvec2(pixel.x * frame.samples + uint(gl_SampleID), pixel.y));
}
#endif

// Implements Renderer in a build without Vulkan: its constructor throws.
#include "pellucid/render.h"

namespace pellucid {

struct Renderer::Implementation {
  DeviceInfo info;
};

Renderer::Renderer(const DeviceOptions& /*options*/) {
  throw Error(ErrorKind::bad_argument,
              "pellucid was built without Vulkan: only the reference on the CPU can draw");
}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
const DeviceInfo& Renderer::info() const {
  return implementation_->info;
}
void Renderer::load(const RenderScene& /*scene*/) {}
RenderResult Renderer::draw(const Camera& /*camera*/, const RenderOptions& /*options*/,
                            Progress* /*progress*/) {
  return {};
}
OverdrawCount Renderer::count_overdraw(const Camera& /*camera*/) {
  return {};
}
std::vector<std::string> Renderer::validation_messages() const {
  return {};
}

std::span<const TechniqueInfo> render_techniques() {
  return {};
}
std::string missing_for(const TechniqueInfo& /*technique*/, const DeviceInfo& /*device*/) {
  return "";
}

}  // namespace pellucid

// Loop subdivision: see pellucid/subdivide.h. The rules are OpenSubdiv's; it is given manifold pieces only,
// because it does not promise anything sensible about others.
#include "pellucid/subdivide.h"

#ifdef PELLUCID_WITH_OPENSUBDIV
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>
#endif

#include <memory>

#include "mesh/manifold_pieces.h"

namespace pellucid {
namespace {

constexpr std::uint64_t kMostTriangles = std::uint64_t{1} << 28U;

#ifdef PELLUCID_WITH_OPENSUBDIV

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

std::unique_ptr<Far::TopologyRefiner> refine(const ManifoldPieces& pieces, std::uint32_t levels) {
  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  std::vector<int> corners_of_faces(pieces.triangles.size(), 3);
  std::vector<Far::Index> corners;
  corners.reserve(3 * pieces.triangles.size());
  for (const Triangle& t : pieces.triangles) {
    for (const std::uint32_t v : t) corners.push_back(static_cast<Far::Index>(v));
  }
  Far::TopologyDescriptor topology;
  topology.numVertices = static_cast<int>(pieces.welded.size());
  topology.numFaces = static_cast<int>(pieces.triangles.size());
  topology.numVertsPerFace = corners_of_faces.data();
  topology.vertIndicesPerFace = corners.data();

  Sdc::Options rules;
  rules.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
  std::unique_ptr<Far::TopologyRefiner> refiner(
      Factory::Create(topology, Factory::Options(Sdc::SCHEME_LOOP, rules)));
  if (refiner == nullptr) throw Error(ErrorKind::internal, "subdivision: the topology was refused");
  refiner->RefineUniform(Far::TopologyRefiner::UniformOptions(static_cast<int>(levels)));
  return refiner;
}

// The faces of the last level, children of one face after the other.
std::vector<Far::Index> faces_by_parent(const Far::TopologyRefiner& refiner, std::uint32_t levels) {
  std::vector<Far::Index> faces(static_cast<std::size_t>(refiner.GetLevel(0).GetNumFaces()));
  for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = static_cast<Far::Index>(f);
  for (std::uint32_t level = 0; level < levels; ++level) {
    std::vector<Far::Index> children;
    children.reserve(4 * faces.size());
    for (const Far::Index face : faces) {
      const Far::ConstIndexArray next = refiner.GetLevel(static_cast<int>(level)).GetFaceChildFaces(face);
      children.insert(children.end(), next.begin(), next.end());
    }
    faces = std::move(children);
  }
  return faces;
}

void copy_triangles(const Far::TopologyRefiner& refiner, const ManifoldPieces& pieces, std::uint32_t levels,
                    Subdivision& result) {
  const std::vector<Far::Index> faces = faces_by_parent(refiner, levels);
  const Far::TopologyLevel& last = refiner.GetLevel(static_cast<int>(levels));
  result.triangles.reserve(faces.size());
  result.source.reserve(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Far::ConstIndexArray v = last.GetFaceVertices(faces[i]);
    result.triangles.push_back({static_cast<std::uint32_t>(v[0]), static_cast<std::uint32_t>(v[1]),
                                static_cast<std::uint32_t>(v[2])});
    result.source.push_back(pieces.source[i >> (2 * levels)]);
  }
}

void copy_stencils(const Far::TopologyRefiner& refiner, const ManifoldPieces& pieces, Subdivision& result) {
  using Factory = Far::StencilTableFactoryReal<double>;
  Factory::Options options;
  options.generateIntermediateLevels = false;
  const std::unique_ptr<const Far::StencilTableReal<double>> table(Factory::Create(refiner, options));
  result.first.reserve(table->GetSizes().size() + 1);
  for (const int size : table->GetSizes()) {
    result.first.push_back(result.first.back() + static_cast<std::uint32_t>(size));
  }
  result.control.reserve(table->GetControlIndices().size());
  for (const Far::Index v : table->GetControlIndices()) {
    result.control.push_back(pieces.welded[static_cast<std::size_t>(v)]);
  }
  result.weights = table->GetWeights();
}

void subdivide_pieces(const ManifoldPieces& pieces, std::uint32_t levels, Subdivision& result) {
  const auto refiner = refine(pieces, levels);
  copy_triangles(*refiner, pieces, levels, result);
  copy_stencils(*refiner, pieces, result);
}

#else

void subdivide_pieces(const ManifoldPieces& /*pieces*/, std::uint32_t /*levels*/, Subdivision& /*result*/) {
  throw Error(ErrorKind::bad_argument,
              "subdivision: this build of pellucid cannot subdivide (PELLUCID_OPENSUBDIV is off)");
}

#endif

void copy_control_mesh(const ManifoldPieces& pieces, Subdivision& result) {
  result.triangles = pieces.triangles;
  result.source = pieces.source;
  result.control = pieces.welded;
  result.weights.assign(pieces.welded.size(), 1.0);
  for (std::uint32_t v = 1; v <= pieces.welded.size(); ++v) result.first.push_back(v);
}

}  // namespace

bool can_subdivide() {
#ifdef PELLUCID_WITH_OPENSUBDIV
  return true;
#else
  return false;
#endif
}

Subdivision subdivide_loop(std::span<const Triangle> triangles, std::span<const std::uint32_t> weld,
                           std::uint32_t levels) {
  if (levels > kMostSubdivisions) {
    throw Error(ErrorKind::bad_argument, "subdivision: " + std::to_string(levels) + " levels; the most is " +
                                             std::to_string(kMostSubdivisions));
  }
  if (triangles.size() > kMostTriangles >> (2 * levels)) {
    throw Error(ErrorKind::bad_argument, "subdivision: " + std::to_string(triangles.size()) +
                                             " triangles become more than " + std::to_string(kMostTriangles) +
                                             " in " + std::to_string(levels) + " levels; use fewer");
  }
  const ManifoldPieces pieces = make_manifold(triangles, weld);
  Subdivision result;
  if (levels == 0 || pieces.triangles.empty()) {
    copy_control_mesh(pieces, result);
    return result;
  }
  subdivide_pieces(pieces, levels, result);
  return result;
}

std::vector<Vec3f> refined_values(const Subdivision& subdivision, std::span<const Vec3f> values) {
  std::vector<Vec3f> refined(subdivision.vertices());
  for (std::size_t v = 0; v < refined.size(); ++v) {
    Vec3d sum;
    for (std::uint32_t i = subdivision.first[v]; i < subdivision.first[v + 1]; ++i) {
      sum += to_double(values[subdivision.control[i]]) * subdivision.weights[i];
    }
    refined[v] = to_float(sum);
  }
  return refined;
}

Mesh subdivide(const Mesh& mesh, std::uint32_t levels) {
  Subdivision subdivision = subdivide_loop(mesh.triangles, weld_by_position(mesh.positions), levels);
  Mesh refined;
  refined.positions = refined_values(subdivision, mesh.positions);
  refined.triangles = std::move(subdivision.triangles);
  if (!mesh.normals.empty()) refined.normals = vertex_normals(refined);
  return refined;
}

}  // namespace pellucid

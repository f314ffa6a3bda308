#include "bench/embree_points.hpp"

#include <Eigen/Geometry>
#include <embree3/rtcore.h>

#include <limits>
#include <vector>

namespace cowgpu::bench {
namespace {

using Vec3f = Eigen::Vector3f;

// C. Ericson, Real-Time Collision Detection (2005), 5.1.5; as Embree's own tutorial does it.
Vec3f closest_on_triangle(const Vec3f& p, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3f ab = b - a, ac = c - a, ap = p - a;
  const float d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3f bp = p - b;
  const float d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const Vec3f cp = p - c;
  const float d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const float scale = 1 / (va + vb + vc);
  return a + vb * scale * ab + vc * scale * ac;
}

} // namespace

struct EmbreePoints::Scene {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = rtcNewScene(device);
  std::vector<Vec3f> vertices;
  std::vector<Face> faces;

  struct Search {
    const Scene* scene;
    Vec3f point;
    std::uint32_t face;
  };

  static bool visit(RTCPointQueryFunctionArguments* arguments) {
    auto& search = *static_cast<Search*>(arguments->userPtr);
    const Face& f = search.scene->faces[arguments->primID];
    const auto& v = search.scene->vertices;
    const Vec3f p(arguments->query->x, arguments->query->y, arguments->query->z);
    const Vec3f q = closest_on_triangle(p, v[f[0]], v[f[1]], v[f[2]]);
    const float distance = (q - p).norm();
    if (!(distance < arguments->query->radius)) return false;
    arguments->query->radius = distance;
    search.point = q;
    search.face = arguments->primID;
    return true;
  }
};

EmbreePoints::EmbreePoints(std::span<const Vec3> vertices, std::span<const Face> faces)
    : scene_(std::make_unique<Scene>()) {
  Scene& s = *scene_;
  for (const Vec3& v : vertices) s.vertices.push_back(v.cast<float>());
  s.faces.assign(faces.begin(), faces.end());
  const RTCGeometry geometry = rtcNewGeometry(s.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* to = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                         3 * sizeof(float), s.vertices.size()));
  for (const Vec3f& v : s.vertices)
    for (int c = 0; c < 3; ++c) *to++ = v[c];
  auto* index = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), s.faces.size()));
  for (const Face& f : s.faces)
    for (const std::uint32_t v : f) *index++ = v;
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
  rtcSetGeometryPointQueryFunction(geometry, Scene::visit);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(s.scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcSetSceneBuildQuality(s.scene, RTC_BUILD_QUALITY_HIGH);
  rtcCommitScene(s.scene);
}

EmbreePoints::~EmbreePoints() {
  rtcReleaseScene(scene_->scene);
  rtcReleaseDevice(scene_->device);
}

EmbreePoints::Found EmbreePoints::closest(const Vec3& query) const {
  RTCPointQuery point{float(query.x()), float(query.y()), float(query.z()), 0, std::numeric_limits<float>::infinity()};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  Scene::Search search{scene_.get(), Vec3f::Zero(), 0};
  rtcPointQuery(scene_->scene, &point, &context, nullptr, &search);
  return {search.point.cast<double>(), search.face};
}

} // namespace cowgpu::bench

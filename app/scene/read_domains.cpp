#include "app/scene/readers.hpp"

#include <fmt/format.h>

namespace fascia::app {
namespace {

BoxDomain read_box(const TableReader& box) {
  const auto min = box.vector("min"), max = box.vector("max");
  if (min && max)
    for (int i = 0; i < 3; ++i)
      if (!((*min)[i] < (*max)[i]))
        box.error("max",
                  fmt::format("{} along {} is not above min, {}; must be above it", (*max)[i], "xyz"[i], (*min)[i]));
  return {min.value_or(Vec3d{}), max.value_or(Vec3d{})};
}

CylinderDomain read_cylinder(const TableReader& cylinder) {
  const auto from = cylinder.vector("from"), to = cylinder.vector("to");
  if (from && to && *from == *to) cylinder.error("to", "is the same point as from; must be another point");
  return {from.value_or(Vec3d{}), to.value_or(Vec3d{}), cylinder.number("radius").value_or(1)};
}

FileDomain read_file(const TableReader& domain, const std::filesystem::path& folder) {
  const std::string name = *domain.text("file");
  if (name.empty()) domain.error("file", "is empty; must be the path of a mesh");
  return {folder / name};
}

}  // namespace

Domain read_domain(const TableReader& domain, const std::filesystem::path& folder) {
  if (domain.value("file")) return read_file(domain, folder);
  if (domain.value("cylinder")) return read_cylinder(domain.table("cylinder"));
  if (domain.value("ellipsoid")) {
    const TableReader ellipsoid = domain.table("ellipsoid");
    return EllipsoidDomain{ellipsoid.vector("center").value_or(Vec3d{}),
                           ellipsoid.vector("radii").value_or(Vec3d{{1, 1, 1}})};
  }
  return read_box(domain.table("box"));
}

}  // namespace fascia::app

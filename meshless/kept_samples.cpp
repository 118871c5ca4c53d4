#include "meshless/kept_samples.hpp"

#include "core/base/index.hpp"

#include <variant>

namespace fascia {
namespace {

/// Changes with what this file writes and with how samples are made.
constexpr int kVersion = 3;
/// Places at which the functions of a domain are asked, in each direction of its bounding box.
constexpr int kAsked = 8;

}  // namespace

SampleDescription::SampleDescription(std::string_view what, const MatterParts& parts, const SampleChoice& choice)
    : text_(what) {
  add(kVersion);
  add(parts.solid.has_value());
  if (parts.solid) add_solid(*parts.solid);
  add(parts.sheets.size());
  for (const SheetPart& sheet : parts.sheets) {
    add_mesh(sheet.surface);
    add_all(std::span(sheet.thickness));
  }
  add(parts.lines.size());
  for (const LinePart& line : parts.lines) {
    add_all(std::span(line.points));
    add(line.segments.size());
    for (const auto& s : line.segments) add(s[0]).add(s[1]);
    add(line.radius);
  }
  for (int i = 0; i < 3; ++i) add(parts.rotation.row(i));
  add(parts.translation);
  add_choice(choice);
}

void SampleDescription::add_solid(const SolidDomain& solid) {
  add(solid.min).add(solid.max).add(solid.volume);
  add_mesh(solid.surface);
  add(static_cast<bool>(solid.contains)).add(static_cast<bool>(solid.distance));
  for (int k = 0; k < kAsked; ++k)
    for (int j = 0; j < kAsked; ++j)
      for (int i = 0; i < kAsked; ++i) {
        const Vec3d part{{(i + 0.5) / kAsked, (j + 0.5) / kAsked, (k + 0.5) / kAsked}};
        Vec3d x;
        for (int a = 0; a < 3; ++a) x[a] = solid.min[a] + part[a] * (solid.max[a] - solid.min[a]);
        if (solid.contains) add(solid.contains(x));
      }
}

void SampleDescription::add_mesh(const TriangleMesh& mesh) {
  add_all(std::span(mesh.points));
  add(mesh.triangles.size());
  for (const auto& t : mesh.triangles) add(t[0]).add(t[1]).add(t[2]);
}

void SampleDescription::add_choice(const SampleChoice& choice) {
  add(choice.index());
  if (const auto* spaced = std::get_if<SpacedChoice>(&choice)) add(spaced->spacing).add(spaced->seed);
  if (const auto* counted = std::get_if<CountedChoice>(&choice)) add(counted->count).add(counted->seed);
  if (const auto* listed = std::get_if<ListedChoice>(&choice))
    add_all(std::span(listed->position)).add_all(std::span(listed->rotation)).add_all(std::span(listed->volume));
}

}  // namespace fascia

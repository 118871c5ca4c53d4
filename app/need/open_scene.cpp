#include "app/need/open_scene.hpp"

#include "app/scene/toml_text.hpp"
#include "assembly/bodies/read_files.hpp"
#include "io/mesh/mesh_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace fascia::app {
namespace {

/// Of solids: cells of the coarsest pattern may be longer than wide, as bent bodies are. More along one edge than this
/// would be a dear beginning for thin ones.
constexpr double kSlender = 4;
constexpr int kMostOfPattern = 4;
/// A part of a cell beyond which there is another one.
constexpr double kAnother = 0.2;

std::vector<double> edges_of(const BlockDomain& block) {
  const auto edge = [&](std::size_t a, std::size_t b) { return norm(block.corners[b] - block.corners[a]); };
  return {std::max({edge(0, 1), edge(3, 2), edge(4, 5), edge(7, 6)}),
          std::max({edge(0, 3), edge(1, 2), edge(4, 7), edge(5, 6)}),
          std::max({edge(0, 4), edge(1, 5), edge(2, 6), edge(3, 7)})};
}

std::vector<double> extents(const Vec3d& d) { return {d[0], d[1], d[2]}; }

/// Edges of the box around a solid that a grid of frames fills.
std::vector<double> box_around(const Body& body) {
  if (const auto* box = std::get_if<BoxDomain>(&body.domain)) return extents(box->max - box->min);
  if (const auto* ball = std::get_if<EllipsoidDomain>(&body.domain)) return extents(2 * ball->radii);
  if (const auto* cylinder = std::get_if<CylinderDomain>(&body.domain)) {
    const Vec3d axis = cylinder->to - cylinder->from;
    const double length = norm(axis);
    Vec3d d;
    for (int i = 0; i < 3; ++i) {
      const double along = std::abs(axis[i]) / length;
      d[i] = std::abs(axis[i]) + 2 * cylinder->radius * std::sqrt(std::max(0.0, 1 - along * along));
    }
    return extents(d);
  }
  const auto& file = std::get<FileDomain>(body.domain);
  const Mesh mesh = read_for(file.place, file.path, file.read, MidNodes::drop);
  Vec3d low{{INFINITY, INFINITY, INFINITY}}, high = -1 * low;
  for (const Vec3d& p : mesh.points)
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], p[i]);
      high[i] = std::max(high[i], p[i]);
    }
  return extents(high - low);
}

class Opening {
 public:
  Opening(const Scene& scene, const Body& body) : scene_(scene), body_(body), path_("bodies." + toml_key(body.name)) {
    open_.name = body.name;
  }

  OpenBody take() {
    if (body_.model == BodyModel::meshless)
      frames();
    else if (is_shell(body_))
      shell();
    else
      elements();
    if (open_.pattern.empty() && !open_.cut) fixed();
    return std::move(open_);
  }

 private:
  bool says(const std::string& key) const { return scene_.says(path_ + "." + key); }
  void family(const std::string& name, std::vector<std::string> keys, int least) {
    for (std::string& key : keys) key.insert(0, path_ + ".");
    open_.families.push_back({name, std::move(keys), least});
  }
  void cells(const std::string& domain, std::vector<int> pattern) {
    open_.key = path_ + ".domain." + domain + ".cells";
    if (body_.open) open_.pattern = std::move(pattern);
  }
  void fixed() {
    if (const auto* grid = std::get_if<GridFrames>(&body_.frames); body_.model == BodyModel::meshless && grid) {
      open_.pattern = grid->count;
      for (int& n : open_.pattern) --n;
      open_.key = path_ + ".frames.grid";
      open_.frames = true;
    } else if (body_.cells) {
      open_.pattern = body_.cells->count;
    }
    open_.fixed = !open_.pattern.empty();
  }
  void cut() {
    open_.cut = !says("domain.refine");
    open_.key = path_ + ".domain.refine";
  }

  void frames() {
    const bool surface = std::holds_alternative<RectangleDomain>(body_.domain),
               line = std::holds_alternative<LineDomain>(body_.domain);
    const bool box = std::holds_alternative<BoxDomain>(body_.domain);
    open_.dimension = line ? 1 : surface ? 2 : 3;
    // A grid around a curved body needs inner cells; rigid frames of a solid need three through it (manual, Meshless
    // bodies).
    const int least = line || surface ? 4 : box ? 2 : 3;
    if (body_.affine || !says("frames.kind")) family("affine frames", {}, line || surface ? 2 : box ? 1 : 3);
    if (!body_.affine) open_.families.insert(open_.families.begin(), Family{"rigid frames", {}, least});
    if (!says("frames.kind"))
      for (Family& f : open_.families)
        f.overrides = {path_ + ".frames.kind=\"" + (f.name.starts_with("affine") ? "affine" : "rigid") + "\""};
    if (!body_.open) return;
    open_.key = path_ + ".frames.grid";
    open_.frames = true;
    if (line)
      open_.pattern = {1};
    else if (const auto* r = std::get_if<RectangleDomain>(&body_.domain))
      open_.pattern = pattern_of({norm(r->edge_u), norm(r->edge_v)}, 2, kMostOfPattern);
    else
      open_.pattern = pattern_of(box_around(body_), box ? kSlender : 2, kMostOfPattern);
  }

  void elements() {
    const char* name = body_.model == BodyModel::tetrahedra ? "tetrahedra" : "hexahedra";
    const bool choose = !says("order") && body_.locking != Locking::f_bar;
    const bool file = std::holds_alternative<FileDomain>(body_.domain);
    const auto add = [&](int order) {
      const int least = file || !body_.open ? 1 : order == 1 ? 2 : 1;
      family(fmt::format("{} {}", order == 1 ? "linear" : "quadratic", name),
             choose ? std::vector{fmt::format("order={}", order)} : std::vector<std::string>{}, least);
    };
    if (choose || body_.order == 1) add(1);
    if (choose || body_.order == 2) add(2);
    if (const auto* box = std::get_if<BoxDomain>(&body_.domain))
      cells("box", pattern_of(extents(box->max - box->min), kSlender, kMostOfPattern));
    else if (const auto* block = std::get_if<BlockDomain>(&body_.domain))
      cells("block", pattern_of(edges_of(*block), kSlender, kMostOfPattern));
    else if (const auto* cylinder = std::get_if<CylinderDomain>(&body_.domain))
      cells("cylinder", round_pattern(norm(cylinder->to - cylinder->from), cylinder->radius));
    else if (std::holds_alternative<EllipsoidDomain>(body_.domain))
      cells(ball_key(), {4, 1});
    else
      cut();
  }

  /// Eight cells around are 2 x 2 in the core and one layer.
  static std::vector<int> round_pattern(double length, double radius) {
    constexpr int around = 8;
    constexpr double across = 4;  // cells in a diameter
    const double size = 2 * radius / across;
    return {std::clamp(static_cast<int>(std::lround(length / (kSlender * size))), 1, 4 * kMostOfPattern), around};
  }

  const char* ball_key() const { return says("domain.sphere") ? "sphere" : "ellipsoid"; }

  void shell() {
    open_.dimension = 2;
    family("triangles", {}, std::holds_alternative<FileDomain>(body_.domain) ? 1 : 4);
    if (const auto* r = std::get_if<RectangleDomain>(&body_.domain)) {
      cells("rectangle", pattern_of({norm(r->edge_u), norm(r->edge_v)}, 1.5, kMostOfPattern));
    } else if (const auto* a = std::get_if<AnnulusDomain>(&body_.domain)) {
      const double around = (a->angle[1] - a->angle[0]) * (a->inner + a->outer) / 2;
      cells("annulus", pattern_of({a->outer - a->inner, around}, 1.5, kMostOfPattern));
    } else if (const auto* c = std::get_if<CylinderDomain>(&body_.domain)) {
      const double around = (c->angle[1] - c->angle[0]) * c->radius;
      std::vector<int> pattern = pattern_of({norm(c->to - c->from), around}, 1.5, kMostOfPattern);
      if (c->closed) pattern[1] = std::max(pattern[1], 2);
      cells("cylinder", pattern);
    } else if (std::holds_alternative<EllipsoidDomain>(body_.domain)) {
      cells(ball_key(), {4});
    } else {
      cut();
    }
  }

  const Scene& scene_;
  const Body& body_;
  std::string path_;
  OpenBody open_;
};

bool resizable(const OpenBody& body) { return body.cut || (!body.pattern.empty() && !body.fixed); }

const Family& family_of(const OpenBody& body, int family) {
  return body.families[std::min(static_cast<std::size_t>(family), body.families.size() - 1)];
}

bool has(const std::vector<int>& list, int item) { return std::find(list.begin(), list.end(), item) != list.end(); }

std::vector<int> thin_directions_of(const OpenBody& body) {
  std::vector<int> thin;
  if (body.fixed || body.pattern.empty() || std::ranges::max(body.pattern) == 1) return thin;
  for (std::size_t i = 0; i < body.pattern.size(); ++i)
    if (body.pattern[i] == 1) thin.push_back(static_cast<int>(i));
  return thin;
}

/// Numbers of cells or frames of a body, along some directions twice the cells.
std::vector<int> counts_of(const OpenBody& body, const Resolution& r, const std::vector<int>& doubled = {}) {
  const Family& family = family_of(body, r.family);
  const std::vector<int> thin = thin_directions_of(body);
  std::vector<int> counts = body.pattern;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const int direction = static_cast<int>(i);
    counts[i] *= has(family.settled, direction) ? std::min(r.level, family.least) : r.level;
    if (!has(thin, direction)) counts[i] *= family.stretch;
    if (has(doubled, direction)) counts[i] *= 2;
    if (body.frames) ++counts[i];
  }
  return counts;
}

std::string numbers_key(const OpenBody& body, const std::vector<int>& counts) {
  return fmt::format("{}=[{}]", body.key, fmt::join(counts, ", "));
}

}  // namespace

std::vector<int> pattern_of(const std::vector<double>& lengths, double slender, int most) {
  const auto [least, largest] = std::minmax_element(lengths.begin(), lengths.end());
  const double size = std::max(slender * *least, *largest / most);
  std::vector<int> pattern;
  pattern.reserve(lengths.size());
  for (const double length : lengths)
    pattern.push_back(std::max(1, static_cast<int>(std::ceil(length / size - kAnother))));
  return pattern;
}

int OpenScene::families() const {
  std::size_t most = 1;
  for (const OpenBody& body : bodies) most = std::max(most, body.families.size());
  return static_cast<int>(most);
}

bool OpenScene::resizes() const { return std::any_of(bodies.begin(), bodies.end(), resizable); }

bool OpenScene::offers(const Resolution& r) const { return takes(r) && (resizes() || r.level == 1); }

bool OpenScene::takes(const Resolution& r) const {
  if (r.level < 1) return false;
  if (r.level > 1 &&
      std::none_of(bodies.begin(), bodies.end(), [](const OpenBody& b) { return b.cut || !b.pattern.empty(); }))
    return false;
  const bool power = std::has_single_bit(static_cast<unsigned>(r.level));
  return power || std::none_of(bodies.begin(), bodies.end(), [](const OpenBody& b) { return b.cut; });
}

int OpenScene::least(int family) const {
  int least = 1;
  for (const OpenBody& body : bodies) least = std::max(least, family_of(body, family).least);
  while (!takes({family, least})) --least;
  return least;
}

double OpenScene::order(int family) const {
  double order = INFINITY;
  for (const OpenBody& body : bodies) order = std::min(order, family_of(body, family).order);
  return std::isfinite(order) ? order : 2;
}

int OpenScene::dimension() const {
  int most = 1;
  for (const OpenBody& body : bodies) most = std::max(most, body.dimension);
  return most;
}

std::vector<std::string> OpenScene::overrides(const Resolution& r) const {
  std::vector<std::string> all;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Family& family = family_of(bodies[b], r.family);
    all.insert(all.end(), family.overrides.begin(), family.overrides.end());
    if (const std::optional<std::string> chosen = numbers(r, b)) all.push_back(*chosen);
  }
  return all;
}

std::vector<int> OpenScene::thin_directions(std::size_t body) const { return thin_directions_of(bodies[body]); }

std::string OpenScene::doubled(const Resolution& r, std::size_t body, const std::vector<int>& directions) const {
  return numbers_key(bodies[body], counts_of(bodies[body], r, directions));
}

std::optional<std::string> OpenScene::numbers(const Resolution& r, std::size_t body) const {
  const OpenBody& b = bodies[body];
  if (b.cut && std::has_single_bit(static_cast<unsigned>(r.level)))
    return fmt::format("{}={}", b.key, std::bit_width(static_cast<unsigned>(r.level)) - 1);
  return b.cut || b.pattern.empty() ? std::nullopt : std::optional(numbers_key(b, counts_of(b, r)));
}

Family& OpenScene::family(std::size_t body, int number) {
  std::vector<Family>& families = bodies[body].families;
  return families[std::min(static_cast<std::size_t>(number), families.size() - 1)];
}

std::string OpenScene::text(const Resolution& r) const {
  std::vector<std::string> parts;
  for (const OpenBody& body : bodies) {
    std::string part = fmt::format("{}: {}", body.name, family_of(body, r.family).name);
    const std::vector<int> counts = counts_of(body, r);
    if (!counts.empty()) part += fmt::format(", {} {}", fmt::join(counts, " x "), body.frames ? "frames" : "cells");
    if (body.cut && r.level > 1)
      part += fmt::format(", cells cut {} times", std::bit_width(static_cast<unsigned>(r.level)) - 1);
    parts.push_back(part);
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

OpenScene open_parts(const Scene& scene) {
  OpenScene open;
  for (const Body& body : scene.bodies) {
    if (is_carrier(body)) continue;
    open.bodies.push_back(Opening(scene, body).take());
  }
  if (!open.resizes()) return open;
  for (OpenBody& body : open.bodies)
    if (body.fixed) body.pattern.clear();
  std::erase_if(open.bodies, [](const OpenBody& b) { return !resizable(b) && b.families.size() < 2; });
  return open;
}

}  // namespace fascia::app

#include "assembly/specification/check.hpp"
#include "assembly/specification/errors.hpp"

#include <fmt/format.h>

#include <map>

namespace fascia {

namespace {

/// Another body that must be there first, and where that is said.
struct Need {
  std::size_t body;
  Place place;
};

std::vector<std::vector<Need>> needs_of(const std::vector<Body>& bodies) {
  std::map<std::string, std::size_t> index;
  for (std::size_t b = 0; b < bodies.size(); ++b) index.emplace(bodies[b].name, b);
  std::vector<std::vector<Need>> needs(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto add = [&](const std::string& name, const Place& place) {
      const auto found = index.find(name);
      if (found != index.end() && found->second != b) needs[b].push_back({found->second, place});
    };
    if (const auto* between = std::get_if<BetweenDomain>(&bodies[b].domain))
      for (std::size_t i = 0; i < 2; ++i) add(between->bodies[i], between->places[i]);
    if (bodies[b].shares)
      for (const SharedNodes& share : *bodies[b].shares) add(share.body, share.body_place);
  }
  return needs;
}

/// A body on the way and the next of its needs.
struct Step {
  std::size_t body, next = 0;
};

/// The names of a circle: from a body on the way to its end, and back.
std::string chain(const std::vector<Body>& bodies, const std::vector<Step>& way, std::size_t closing) {
  std::string text;
  bool inside = false;
  for (const Step& step : way) {
    inside = inside || step.body == closing;
    if (inside) text += bodies[step.body].name + " → ";
  }
  return text + bodies[closing].name;
}

}  // namespace

std::vector<Diagnostic> circles_of(const std::vector<Body>& bodies) {
  std::vector<Diagnostic> circles;
  enum class Visit { open, on_the_way, done };
  const std::vector<std::vector<Need>> needs = needs_of(bodies);
  std::vector<Visit> visit(bodies.size(), Visit::open);
  for (std::size_t first = 0; first < bodies.size(); ++first) {
    if (visit[first] != Visit::open) continue;
    std::vector<Step> way{{first}};
    visit[first] = Visit::on_the_way;
    while (!way.empty()) {
      Step& step = way.back();
      if (step.next == needs[step.body].size()) {
        visit[step.body] = Visit::done;
        way.pop_back();
        continue;
      }
      const Need& need = needs[step.body][step.next++];
      if (visit[need.body] == Visit::on_the_way)
        circles.push_back(
            {need.place, fmt::format("closes a circle, {}; share and between must not lead back to a body",
                                     chain(bodies, way, need.body))});
      if (visit[need.body] != Visit::open) continue;
      visit[need.body] = Visit::on_the_way;
      way.push_back({need.body});
    }
  }
  return circles;
}

}  // namespace fascia

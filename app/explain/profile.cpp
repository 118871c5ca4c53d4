#include "app/explain/profile.hpp"

#include "core/base/index.hpp"
#include "core/node/dof_filter.hpp"

#include <algorithm>

namespace fascia::app {

std::vector<BodyProfile> profile_of(const Simulation& s) {
  const DofFilter filter(s.model);
  std::vector<BodyProfile> profiles;
  for (const SimulatedBody& b : s.bodies) {
    const ModelBody& body = *b.body;
    BodyProfile& p = profiles.emplace_back();
    p.name = b.name;
    p.model = body.model_name();
    p.points = body.points().size();
    p.cells = body.cells().nodes.size() / at(body.cells().nodes_per_cell);
    p.mass = body.mass();
    const DofLayout& dofs = s.model.points.dofs;
    for (int i = body.first_node(); i < body.first_node() + body.node_count(); ++i)
      for (int dof = dofs.begin(i); dof < dofs.begin(i) + dofs.size(i); ++dof)
        p.unknowns += filter.is_fixed(at(dof)) ? 0 : 1;
  }
  return profiles;
}

Stages stages_of(const nlohmann::ordered_json& summary, const RunRecord& record, double program, double built) {
  Stages stages;
  stages.setup = record.setup.median;
  stages.solve = record.solve.median;
  if (const auto seconds = summary.find("seconds"); seconds != summary.end()) {
    stages.output = seconds->value("output", 0.0);
    // The summary and the time from start to end are those of one run.
    const double told = seconds->value("setup", 0.0) + seconds->value("solve", 0.0) + stages.output;
    stages.start = std::max(0.0, record.wall - told);
  }
  stages.memory_start = std::min(program, record.memory);
  stages.memory_setup = std::clamp(built - program, 0.0, record.memory - stages.memory_start);
  stages.memory_run = record.memory - stages.memory_start - stages.memory_setup;
  return stages;
}

void share_out(Explanation& e) {
  double points = 0;
  for (const BodyProfile& b : e.bodies) points += static_cast<double>(b.points);
  for (BodyProfile& b : e.bodies) {
    b.time = {points > 0 ? static_cast<double>(b.points) / points : 0, true, ""};
    for (const VariantKind kind : {VariantKind::rigid, VariantKind::left_out})  // the latter counts where both are
      for (const Part& part : e.parts) {
        if (part.variant.kind != kind || part.variant.body != b.name || !part.measured()) continue;
        b.memory = 1 - part.memory;
        // Without a body another number of iterations is needed, which says nothing about what it takes in each.
        const double iterations =
            part.record->newton > 0 ? static_cast<double>(e.base.newton) / part.record->newton : 1;
        if (part.solve.high * iterations < 1)
          b.time = {1 - part.solve.median * iterations, false, kind == VariantKind::rigid ? "as rigid" : "left out"};
      }
  }
}

}  // namespace fascia::app

#include "app/study/tables.hpp"

#include "app/machine.hpp"
#include "app/report/csv.hpp"
#include "app/study/machine_load.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia::app {
namespace {

using Json = nlohmann::ordered_json;

std::string value_text(const RunMeasure& measured) {
  if (measured.value.empty() || !measured.times.empty()) return "";
  if (measured.value.size() == 1) return fmt::format("{}", measured.value[0]);
  std::string text;
  for (const double v : measured.value) text += (text.empty() ? "" : ", ") + fmt::format("{}", v);
  return "[" + text + "]";
}

std::string status_of(const StudyRun& run) {
  if (!run.plan.refused.empty()) return "refused";
  return run.record ? run.record->status : "not run";
}

std::string reason_of(const StudyRun& run) {
  if (!run.plan.refused.empty()) return run.plan.refused;
  return run.record ? run.record->reason : "";
}

Json spread_json(const Spread& s) { return {{"median", s.median}, {"low", s.low}, {"high", s.high}}; }

Json machine_json() {
  const Machine m = this_machine();
  Json j{{"date", m.date}, {"cpu", m.cpu},       {"threads", m.threads}, {"memory", m.memory},     {"system", m.system},
         {"gpu", m.gpu},   {"fascia", m.fascia}, {"commit", m.commit},   {"compiler", m.compiler}, {"flags", m.flags}};
  for (const auto& [name, version] : m.libraries) j["libraries"][name] = version;
  return j;
}

Json run_json(const StudyResult& result, const StudyRun& run) {
  Json j;
  for (std::size_t a = 0; a < run.plan.at.size(); ++a)
    j["axes"][result.study.axes[a].name] = result.study.axes[a].values[run.plan.at[a]].label;
  j["overrides"] = run.plan.overrides;
  if (!run.plan.simulation.empty()) j["simulation"] = run.plan.simulation;
  j["status"] = status_of(run);
  j["reason"] = reason_of(run);
  if (!run.record) return j;
  const RunRecord& r = *run.record;
  j["directory"] = run.plan.directory;
  j["cost"] = spread_json(run.cost);
  for (std::size_t m = 0; m < run.measured.size(); ++m) {
    Json& measure = j["measures"][result.study.measures[m].name];
    measure["value"] = run.measured[m].value;
    if (!run.measured[m].times.empty()) measure["times"] = run.measured[m].times;
    if (run.measured[m].error) measure["error"] = *run.measured[m].error;
    if (!run.measured[m].trouble.empty()) measure["trouble"] = run.measured[m].trouble;
    measure["front"] = run.on_front[m] != 0;
  }
  j["record"] = json_of(r);
  return j;
}

Json budgets_json(const StudyResult& result, std::size_t measure, const std::vector<Budget>& budgets) {
  Json list = Json::array();
  for (const Budget& b : budgets) {
    Json entry{{"limit", b.limit}};
    if (b.best) {
      entry["run"] = *b.best;
      entry["error"] = *result.runs[*b.best].measured[measure].error;
    }
    list.push_back(entry);
  }
  return list;
}

Json question_json(const StudyResult& result, const Question& question) {
  const ReferenceValue& reference = question.reference;
  const StudyMeasure& measure = result.study.measures[question.measure];
  Json j{{"name", question.name}, {"measure", measure.name}};
  if (measure.field.empty())
    j["probe"] = measure.probe;
  else
    j["field"] = measure.field;
  if (!measure.body.empty()) j["body"] = measure.body;
  if (reference.trouble.empty()) {
    j["reference"] = {
        {"value", reference.at.value}, {"uncertainty", reference.uncertainty}, {"source", reference.source}};
    if (!reference.directory.empty()) j["reference"]["directory"] = reference.directory.string();
    if (!reference.at.times.empty()) j["reference"]["times"] = reference.at.times;
  } else {
    j["reference"] = {{"missing", reference.trouble}};
  }
  if (const std::optional<Choices> choices = choices_of(result, question))
    j["choices"] = {
        {"fastest", choices->fastest}, {"most_accurate", choices->most_accurate}, {"chosen", choices->chosen}};
  j["by_cost"] = budgets_json(result, question.measure, by_cost(result, question));
  j["by_unknowns"] = budgets_json(result, question.measure, by_unknowns(result, question));
  return j;
}

std::string front_text(const StudyResult& result, const Question& question) {
  std::vector<std::size_t> front;
  for (const std::size_t r : runs_with_error(result, question))
    if (result.runs[r].on_front[question.measure]) front.push_back(r);
  std::sort(front.begin(), front.end(),
            [&](std::size_t a, std::size_t b) { return result.runs[a].cost.median < result.runs[b].cost.median; });
  std::string text;
  for (const std::size_t r : front) {
    const StudyRun& run = result.runs[r];
    text += fmt::format("  {:>9}  {:>8}  {:>9} unknowns  {}\n", seconds_text(run.cost.median),
                        error_text(*run.measured[question.measure].error), run.record->dofs, label_of(result, run));
  }
  return text;
}

}  // namespace

std::string csv_of(const StudyResult& result) {
  std::string text;
  for (const StudyAxis& axis : result.study.axes) text += csv_cell(axis.name) + ",";
  text += "status";
  for (const StudyMeasure& m : result.study.measures)
    text += "," + csv_cell("error_" + m.name) + "," + csv_cell("value_" + m.name);
  text +=
      ",step_median,step_max,setup,solve,memory,dofs,newton,linear,steps,threads,backend,repeats,solve_low,solve_high,"
      "busy,reason\n";
  for (const StudyRun& run : result.runs) {
    for (std::size_t a = 0; a < run.plan.at.size(); ++a)
      text += csv_cell(result.study.axes[a].values[run.plan.at[a]].label) + ",";
    text += csv_cell(status_of(run));
    for (const RunMeasure& m : run.measured)
      text += "," + (m.error ? fmt::format("{}", *m.error) : "") + "," + csv_cell(value_text(m));
    if (run.record) {
      const RunRecord& r = *run.record;
      text += fmt::format(",{},{},{},{},{:.0f},{},{},{},{},{},{},{},{},{},{},", r.step.median, r.step_max,
                          r.setup.median, r.solve.median, r.memory, r.dofs, r.newton, r.linear, r.steps, r.threads,
                          r.backend, r.repeats, r.solve.low, r.solve.high, r.others);
    } else {
      text += std::string(16, ',');
    }
    text += csv_cell(reason_of(run)) + "\n";
  }
  return text;
}

Json json_of(const StudyResult& result) {
  Json j;
  j["fascia_study"] = 1;
  j["title"] = result.study.title;
  j["base"] = result.study.base.string();
  std::error_code none;
  j["base_file"] = std::filesystem::absolute(result.study.base, none).string();
  j["interrupted"] = result.interrupted;
  j["machine"] = machine_json();
  j["cost"] = cost_name(result.cost);
  j["dimension"] = result.dimension;
  for (const StudyAxis& axis : result.study.axes) {
    Json values = Json::array();
    for (const AxisValue& value : axis.values) values.push_back(value.label);
    j["axes"].push_back({{"name", axis.name}, {"keys", axis.keys}, {"values", values}});
  }
  j["measures"] = Json::array();
  for (const Question& question : result.questions) j["measures"].push_back(question_json(result, question));
  for (const StudyRun& run : result.runs) j["runs"].push_back(run_json(result, run));
  j["series"] = Json::array();
  for (const SizeSeries& s : result.series) {
    Json orders = Json::array();
    for (const std::optional<double>& order : s.order) orders.push_back(order ? Json(*order) : Json(nullptr));
    j["series"].push_back({{"axis", result.study.axes[s.axis].name}, {"runs", s.runs}, {"h", s.h}, {"order", orders}});
  }
  return j;
}

std::vector<std::string> troubles_of(const StudyResult& result, const Question& question) {
  std::vector<std::string> sentences;
  for (const StudyRun& run : result.runs)
    if (const std::string& why = run.measured[question.measure].trouble; !why.empty() && belongs(result, question, run))
      sentences.push_back(fmt::format("no error of {}: {}", label_of(result, run), why));
  return sentences;
}

std::string text_of(const StudyResult& result) {
  std::string text;
  std::size_t done = 0, failed = 0, refused = 0, busy = 0;
  for (const StudyRun& run : result.runs) {
    done += run.converged() ? 1U : 0U;
    refused += run.plan.refused.empty() ? 0U : 1U;
    failed += run.record && !run.converged() ? 1U : 0U;
    busy += run.record && run.record->others > kBusy ? 1U : 0U;
  }
  text += fmt::format("{} runs: {} converged, {} failed, {} are no valid scene{}\n", result.runs.size(), done, failed,
                      refused, result.interrupted ? "; interrupted: call again to go on" : "");
  if (busy > 0 && result.study.timed)
    text += fmt::format("the machine did other work during {} of them: their times are too long\n", busy);
  for (const Question& question : result.questions) {
    const ReferenceValue& reference = question.reference;
    if (!reference.trouble.empty()) {
      text += fmt::format("\n{}: no errors, for want of a reference: {}\n", question.name, reference.trouble);
      continue;
    }
    text += fmt::format("\n{}, beside the time of a {}{}\n  reference: {}; uncertainty: {}\n", question.name,
                        cost_name(result.cost), result.study.timed ? "" : ", not timed with care", reference.source,
                        uncertainty_text(result, question));
    text += front_text(result, question);
    for (const std::string& sentence : troubles_of(result, question)) text += "  " + sentence + "\n";
  }
  return text;
}

}  // namespace fascia::app

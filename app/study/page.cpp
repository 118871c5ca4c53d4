#include "app/study/page.hpp"

#include "app/machine.hpp"
#include "app/other_program.hpp"
#include "app/report/html_page.hpp"
#include "app/study/machine_load.hpp"
#include "app/study/plots.hpp"
#include "app/study/tables.hpp"
#include "core/base/errors.hpp"
#include "io/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace fascia::app {
namespace {

namespace fs = std::filesystem;

constexpr int kPlotWidth = 860, kPlotHeight = 520;

/// Plots that have something to show, with names for files.
std::vector<std::pair<std::string, Plot>> plots_of(const StudyResult& result, const Question& question) {
  std::vector<std::pair<std::string, Plot>> plots;
  const std::string& name = question.name;
  if (!question.reference.trouble.empty()) return plots;
  plots.emplace_back(name + "_cost", front_plot(result, question));
  Plot convergence = convergence_plot(result, question);
  if (!convergence.series.empty()) plots.emplace_back(name + "_convergence", std::move(convergence));
  return plots;
}

void add_budgets(HtmlPage& page, const StudyResult& result, std::size_t measure, const std::string& limit_name,
                 const std::vector<Budget>& budgets, bool time) {
  ReportTable table;
  table.caption = "Smallest error within a limit";
  table.columns = {{limit_name, "", true}, {"error", "", true}, {"run", "", false}};
  for (const Budget& b : budgets) {
    ReportCell limit(time ? seconds_text(b.limit) : fmt::format("{:.0f}", b.limit), b.limit);
    if (!b.best) {
      table.rows.push_back({limit, "none is that cheap", ""});
      continue;
    }
    const double error = *result.runs[*b.best].measured[measure].error;
    table.rows.push_back({limit, {error_text(error), error}, label_of(result, result.runs[*b.best])});
  }
  if (!table.rows.empty()) page.table(table);
}

void add_question(HtmlPage& page, const StudyResult& result, const Question& question) {
  const ReferenceValue& reference = question.reference;
  page.heading(question.name);
  if (!reference.trouble.empty())
    return page.notice("There are no errors, for want of a reference: " + reference.trouble + ".");
  page.paragraph(
      fmt::format("Errors are distances from the reference, relative to it. Reference: {}. Its uncertainty: {}.",
                  reference.source, uncertainty_text(result, question)));
  for (const auto& [name, plot] : plots_of(result, question)) page.plot(svg_of(plot, kPlotWidth, kPlotHeight));
  if (const std::optional<Choices> choices = choices_of(result, question)) {
    const auto sentence = [&](const char* which, std::size_t r) {
      const StudyRun& run = result.runs[r];
      return fmt::format("{}: {}, {}, error {}.", which, label_of(result, run), seconds_text(run.cost.median),
                         error_text(*run.measured[question.measure].error));
    };
    page.list({sentence("Fastest", choices->fastest), sentence("Most accurate", choices->most_accurate),
               sentence(result.study.need ? "Chosen, the cheapest that is good enough"
                                          : "Chosen, where more accuracy begins to cost more than it gains",
                        choices->chosen)});
  }
  if (const std::vector<std::string> troubles = troubles_of(result, question); !troubles.empty()) page.list(troubles);
  add_budgets(page, result, question.measure, cost_name(result.cost), by_cost(result, question), true);
  add_budgets(page, result, question.measure, "unknowns", by_unknowns(result, question), false);
}

ReportTable table_of_runs(const StudyResult& result) {
  ReportTable table;
  table.caption = "All runs";
  for (const StudyAxis& axis : result.study.axes) {
    const bool numeric =
        std::all_of(axis.values.begin(), axis.values.end(), [](const AxisValue& v) { return v.number.has_value(); });
    table.columns.push_back({axis.name, "", numeric});
  }
  table.columns.push_back({"status", "", false});
  for (const StudyMeasure& m : result.study.measures) table.columns.push_back({"error of " + m.name, "", true});
  for (const auto& [name, unit] : {std::pair{"solve", "ms"},
                                   {"lowest", "ms"},
                                   {"highest", "ms"},
                                   {"median step", "ms"},
                                   {"worst step", "ms"},
                                   {"set-up", "ms"},
                                   {"memory", "MB"},
                                   {"unknowns", ""},
                                   {"Newton", ""},
                                   {"linear", ""}})
    table.columns.push_back({name, unit, true});
  for (const StudyRun& run : result.runs) {
    std::vector<ReportCell>& row = table.rows.emplace_back();
    for (std::size_t a = 0; a < run.plan.at.size(); ++a) {
      const AxisValue& value = result.study.axes[a].values[run.plan.at[a]];
      row.push_back(value.number ? ReportCell(value.label, *value.number) : ReportCell(value.label));
    }
    const bool refused = !run.plan.refused.empty();
    if (!run.record) {
      row.push_back(
          state_cell(refused ? ResultState::refused : ResultState::none, refused ? "no valid scene" : "not run"));
      row.resize(table.columns.size());
      continue;
    }
    const RunRecord& r = *run.record;
    row.push_back(state_cell(r.converged()           ? ResultState::right
                             : r.status == "refused" ? ResultState::refused
                                                     : ResultState::stopped,
                             r.status));
    for (const RunMeasure& m : run.measured)
      row.push_back(m.error ? ReportCell(error_text(*m.error), *m.error) : ReportCell("–"));
    for (const double seconds : {r.solve.median, r.solve.low, r.solve.high, r.step.median, r.step_max, r.setup.median})
      row.push_back(number_cell(1e3 * seconds, 3));
    for (const double number :
         {r.memory / 1e6, static_cast<double>(r.dofs), static_cast<double>(r.newton), static_cast<double>(r.linear)})
      row.push_back(number_cell(number, 6));
  }
  return table;
}

void add_failures(HtmlPage& page, const StudyResult& result) {
  ReportTable table;
  table.caption = "Runs without a value, and why";
  table.columns = {{"run", "", false}, {"reason", "", false}};
  for (const StudyRun& run : result.runs) {
    if (!run.plan.refused.empty()) table.rows.push_back({label_of(result, run), "no valid scene: " + run.plan.refused});
    if (run.record && !run.converged())
      table.rows.push_back({label_of(result, run), run.record->status + ": " + run.record->reason});
  }
  if (!table.rows.empty()) page.table(table);
}

void add_timing(HtmlPage& page, const StudyResult& result) {
  const Machine m = this_machine();
  const bool busy = std::any_of(result.runs.begin(), result.runs.end(),
                                [](const StudyRun& r) { return r.record && r.record->others > kBusy; });
  if (!result.study.timed)
    page.notice("Several runs went on at once: their times are not comparable.");
  else if (busy)
    page.notice(
        "The machine did other work during some runs: their times are too long. Run the study again when it is quiet.");
  page.paragraph(
      fmt::format("Times are medians of up to {} runs in processes of their own, one after another, after {} that {} "
                  "not counted; whiskers "
                  "span the shortest and the longest. A run of more than 20 s needs no warm-up. Runs whose spans "
                  "overlap count as equally fast.",
                  result.study.repeat, result.study.warm_up, result.study.warm_up == 1 ? "was" : "were"));
  page.paragraph(fmt::format("{}, {} threads, {:.3g} GB; {}; fascia {} {}, {}", m.cpu, m.threads, m.memory / 1e9,
                             m.system, m.fascia, m.commit, m.compiler));
}

void add_pictures(HtmlPage& page, const StudyResult& result, const fs::path& directory) {
  std::error_code none;
  for (const char* which : {"fastest", "most_accurate", "chosen"}) {
    const fs::path png = directory / "pictures" / (std::string(which) + ".png");
    if (!fs::exists(png, none)) continue;
    const std::string words = std::string(which) == "most_accurate" ? "most accurate" : which;
    page.picture(io::read_file(png),
                 fmt::format("End state of the {} run of {}", words, result.study.base.filename().string()),
                 fmt::format("The {} run", words));
  }
}

}  // namespace

void write_page(const StudyResult& result, const fs::path& directory) {
  HtmlPage page(result.study.title.empty() ? "Study of " + result.study.base.filename().string() : result.study.title);
  if (result.interrupted) page.notice("This study was interrupted; the same command goes on where it stopped.");
  for (const Question& question : result.questions) add_question(page, result, question);
  add_pictures(page, result, directory);
  page.heading("Runs");
  page.table(table_of_runs(result));
  add_failures(page, result);
  page.heading("How it was timed");
  add_timing(page, result);
  const Machine m = this_machine();
  page.footer(fmt::format("fascia {} · {}", m.fascia, m.date));
  io::replace_file(directory / "study.html", page.text());
}

void write_plots(const StudyResult& result, const fs::path& directory, bool png) {
  io::make_directories(directory);
  for (const Question& question : result.questions)
    for (const auto& [name, plot] : plots_of(result, question)) {
      std::string stem;
      for (const char c : name)
        stem += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' ? c : '_';
      const fs::path svg = directory / (stem + ".svg");
      io::replace_file(svg, svg_of(plot, kPlotWidth, kPlotHeight));
      if (!png) continue;
      const fs::path target = directory / (stem + ".png");
      if (run_other_program({"rsvg-convert", "--zoom", "2", "--background-color", "white", "--output", target.string(),
                             svg.string()}) != 0)
        throw InputError(
            "--png: there is no rsvg-convert, which turns plots into pictures; install librsvg2-bin, or use --svg");
      fs::remove(svg);
    }
}

}  // namespace fascia::app

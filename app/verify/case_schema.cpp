#include "app/verify/cases.hpp"

namespace fascia::app {
namespace {

Shape case_schema() {
  const Shape entry = one_of({choice({{"x", "First component of a vector."},
                                      {"y", "Second component."},
                                      {"z", "Third component."},
                                      {"norm", "Root of the sum of the squares."}}),
                              integer(at_least(0)), array(integer(at_least(0)), 1)});
  return table({key("name", text("letters, digits and hyphens"), "Unique among all cases.").needed(),
                key("title", text(), "What is measured, in a few words.").needed(),
                key("probe", text("the name of a probe of the scene"), "Where the value comes from.").needed(),
                key("at", entry, "Which number of the probe's value: a component, an index from 0, or several.")
                    .defaults("a number"),
                key("minus", text("the name of a probe of the scene"), "The same number of this probe is subtracted.")
                    .defaults("nothing"),
                key("over", number("1"), "The value is divided by this.").defaults("1"),
                key("value", number("1"), "The reference, in SI units.").needed(),
                key("unit", text("the SI unit of the value"), "Of the value, for people.").needed(),
                key("source", text(), "Formula with symbols; or author, title, year, table.").needed(),
                key("uncertainty", number("1", at_least(0)), "Of the reference, relative.").defaults("0"),
                key("allowed", number("1", at_least(0)), "Largest error, relative to the reference."),
                key("allowed_absolute", number("1", at_least(0)), "Largest error, in the unit of the value."),
                key("why", text(), "What limits the error; needed where more than 1e-6 is allowed.").defaults("")},
               {{{"allowed", "allowed_absolute"}, true}});
}

Shape run_schema() {
  return table(
      {key("name", text("letters, digits and hyphens"), "Unique among all runs.").needed(),
       key("title", text(), "What is simulated, in a few words.").needed(),
       key("features", array(text("letters, digits and hyphens"), 1), "Words by which the run is found.").needed(),
       key("level", choice({{"full", "Takes more than about 2 s on one core: only with --full."}}),
           "Left out: part of every run.")
           .defaults("always run"),
       key("repeat", boolean(), "Run again on one thread and on all; the results must be equal bit for bit.")
           .defaults("false"),
       key("file", text("the path of a scene"), "Relative to the case file."),
       key("scene", text_of_lines("the text of a scene"), "A whole scene; paths in it are relative to the case file."),
       key("set", array(text("key.path=value")), "Changes, as after --set.").defaults("[]"),
       key("cases", array(case_schema(), 1), "Values that the run must give.").needed()},
      {{{"file", "scene"}, true}});
}

}  // namespace

const Shape& case_file_schema() {
  static const Shape file = table({key("title", text(), "What the cases are about.").defaults("the file's name"),
                                   key("runs", array(run_schema(), 1), "Simulations.").needed()});
  return file;
}

}  // namespace fascia::app

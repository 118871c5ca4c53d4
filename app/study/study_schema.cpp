#include "app/study/study_schema.hpp"

namespace fascia::app {
namespace {

/// Changes of a scene: { "solver.threads" = 2 }.
Shape changes() { return anything("a table of keys and values"); }

Shape alternative() {
  return table({key("name", text("a name"), "As tables show it.").needed(),
                key("set", changes(), "Keys of the scene, in quotes where they have dots, and their values."),
                key("remove", array(text("a key")), "Keys that the scene has and this alternative has not.")});
}

Shape axis() {
  return table(
      {key("name", text("a name"), "Column of the tables.").defaults("the last part of the key"),
       key("key", text("a key of the scene"), "A key that takes each of the values."),
       key("keys", array(text("a key of the scene"), 1), "Keys that are moved together; values are rows of as many."),
       key("values", array(anything("any value"), 1), "Of the key, or rows for the keys."),
       key("alternatives", array(alternative(), 1), "Whole alternatives, each a set of keys."),
       key("refine", array(number("1", above(0)), 1), "Factors on the resolution of `body`, or of all bodies."),
       key("body", text("the name of a body"), "The body whose `models` are compared, or that is refined."),
       key("models",
           array(choice({{"frames", "Meshless, rigid frames on a grid."},
                         {"affine", "Meshless, affine frames on a grid."},
                         {"tetrahedra", "Linear tetrahedra."},
                         {"tetrahedra-2", "Quadratic tetrahedra."},
                         {"hexahedra", "Linear hexahedra."},
                         {"hexahedra-2", "Quadratic hexahedra."},
                         {"shell", "Shells, of a surface."},
                         {"sheet", "Meshless frames in a surface."}}),
                 1),
           "Discretisations of that body; domain, material, mass and cells are kept.")},
      {{{"key", "keys", "alternatives", "models", "refine"}, true}});
}

Shape reference_shape() {
  return one_of(
      {choice({{"finest", "The finest run of the study, extrapolated by Richardson's method, with its uncertainty."}}),
       table({key("value", anything("a number, a quantity with a unit, or a list of these"),
                  "In SI or with units; of a vector a list."),
              key("source", text(), "Where the value is from; needed beside a value."),
              key("uncertainty", number("1", between(0, 1)), "Of the value, relative; needed beside it, 0: exact."),
              key("scene", text("the path of a scene"), "A scene whose run gives the value."),
              key("set", changes(), "Keys that are changed in that scene; without `scene` in the base.")})});
}

/// Fields that a result tells of motion; the others are the same in all runs of a body.
std::vector<Choice> measured_fields() {
  std::vector<Choice> fields = field_choices();
  for (const Choice& field : shell_field_choices())
    if (field.value != "director" && field.value != "thickness") fields.push_back(field);
  return fields;
}

Shape measure() {
  return table(
      {key("name", text("a name"), "Of columns: error_NAME, value_NAME.").defaults("the probe's or the field's"),
       key("probe", text("the name of a probe"), "Of the base scene."),
       key("field", choice(measured_fields()), "A field of the saved states, compared with that of the reference."),
       key("body", text("the name of a body"), "Of the field.").defaults("all bodies"),
       key("component",
           one_of({choice({{"x", ""}, {"y", ""}, {"z", ""}}), integer(at_least(0)), array(integer(at_least(0)), 1, 3)}),
           "An entry of the probe's value: a component, an index of a list from 0, or indices.")
           .defaults("the whole value"),
       key("moment",
           choice({{"end", "The value at the end."},
                   {"largest", "The value where it is largest in magnitude."},
                   {"curve", "All saved times; the error is that of the curve, in the mean square."}}),
           "When it is looked at.")
           .defaults("\"end\""),
       key("per", text("the name of an axis"), "An axis of which each value is a problem with a reference of its own."),
       key("reference", reference_shape(), "What errors are distances from; without it values are told alone.")},
      {{{"probe", "field"}, true}});
}

}  // namespace

const Shape& study_schema() {
  static const Shape study = table(
      {key("title", text(), "One line for people."),
       key("base", text("the path of a scene"), "The scene that is varied, relative to the study.").needed(),
       key("set", changes(), "Keys of the base scene that are changed in all runs."),
       key("remove", array(text("a key")), "Keys of the base scene that all runs are without."),
       key("axes", array(axis(), 1), "What is varied.").needed(),
       key("measures", array(measure(), 1), "What is looked at.").needed(),
       key("mode",
           choice({{"all", "Every combination of the axes' values."},
                   {"paired", "The first values of all axes, the second ones, and so on."},
                   {"front", "From the first values on towards smaller errors, as long as a step is worth its cost."}}),
           "Which combinations are run.")
           .defaults("\"all\""),
       key("cost",
           choice({{"solve", "Time of the solve."},
                   {"step", "Median time of a step."},
                   {"total", "Set-up and solve together."}}),
           "Time that errors are shown against.")
           .defaults("\"step\" of dynamics whose steps are equally long, else \"solve\""),
       key("dimension", integer(between(1, 3)), "Of what is refined: spacing = unknowns^(-1/dimension).")
           .defaults("that of the bodies"),
       key("need", number("1", above(0)), "An error that is good enough: the cheapest run below it is chosen."),
       key("repeat", integer(between(1, 1000)), "Times that each run is timed.").defaults("3"),
       key("warm_up", integer(between(0, 100)), "Runs before that, which are not timed.").defaults("1"),
       key("timed", boolean(), "Runs one after the other; otherwise several at once, and times mean little.")
           .defaults("true"),
       key("time_limit", number("s", above(0)), "Of a single run, after which it is ended."),
       key("budgets", array(number("s", above(0))), "Costs at which the smallest error is told.")
           .defaults("decades of the costs"),
       key("sizes", array(number("1", above(0))), "Numbers of unknowns, likewise.").defaults("decades")});
  return study;
}

}  // namespace fascia::app

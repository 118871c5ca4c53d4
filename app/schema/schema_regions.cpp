#include "app/schema/schema.hpp"

namespace fascia::app {
namespace {

Shape box_region() {
  return table(
      {key("min", vector3("m"), "Lower corner.").needed(), key("max", vector3("m"), "Upper corner.").needed()});
}

Shape cylinder_region() {
  return table({key("from", vector3("m"), "Centre of one end.").needed(),
                key("to", vector3("m"), "Centre of the other end.").needed(),
                key("radius", number("m", above(0)), "Radius.").needed()});
}

Shape shaped_region() {
  const Shape region = reference("region", region_schema);
  return table(
      {key("box", box_region(), "What lies in an axis-aligned box, its faces included."),
       key("sphere",
           table({key("center", vector3("m"), "Centre.").needed(),
                  key("radius", number("m", above(0)), "Radius.").needed()}),
           "What lies in a sphere."),
       key("cylinder", cylinder_region(), "What lies in a cylinder."),
       key("halfspace",
           table({key("point", vector3("m"), "A point of the plane.").needed(),
                  key("normal", vector3("1"), "Points out of what is selected.").needed()}),
           "The side of a plane that the normal leaves."),
       key("nearest", vector3("m"), "The one that is nearest to a point; the lowest index of equals."),
       key("group", one_of({text(), integer(at_least(0))}), "A physical group of the Gmsh file, by name or number."),
       key("ids", array(integer(between(0, 2147483647)), 1), "By index, from zero."),
       key("boundary", boolean(), "`true`: what lies on the surface."),
       key("all_of", array(region, 1), "What every one of the regions selects."),
       key("any_of", array(region, 1), "What at least one of the regions selects."),
       key("not", region, "What the region does not select.")},
      {{{"box", "sphere", "cylinder", "halfspace", "nearest", "group", "ids", "boundary", "all_of", "any_of", "not"}}});
}

}  // namespace

const Shape& region_schema() {
  static const Shape region = one_of({choice({{"all", "Everything."}}), shaped_region()});
  return region;
}

Key over_key() {
  return key("over", number("s", at_least(0)),
             "Time in which the factor grows from 0 to 1. In a static solve it grows over the load steps.")
      .defaults("at once");
}

const Shape& profile_schema() {
  static const Shape profile =
      one_of({choice({{"linear", "In proportion to time."}, {"smooth", "Starts and ends at rest."}}),
              array(tuple({number("s"), number("1")}), 2),
              table({key("sine", table({key("period", number("s", above(0)), "Period.").needed()}),
                         "The factor is a sine of time.")
                         .needed()})});
  return profile;
}

Shape region_reference() { return reference("region", region_schema); }

Key profile_key() {
  return key("profile", reference("profile", profile_schema), "How the factor follows time.").defaults("\"linear\"");
}

Key dial_key() {
  return key("dial", text("a name"),
             "The name of a number by which a program that embeds the library multiplies the factor at every step; it "
             "is 1 in `fascia run`.");
}

}  // namespace fascia::app

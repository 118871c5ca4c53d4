#include "app/scene/schema.hpp"

namespace fascia::app {
namespace {

Key cells(std::size_t count) {
  return key("cells", array(integer(between(1, 10000)), count, count), "Cells of a mesh model.")
      .refused("is not used by a meshless body");
}

Key mesh_only(const char* name, Shape shape, const char* doc) {
  return key(name, std::move(shape), doc).refused("is not used by a meshless body");
}

Shape box() {
  return table({key("min", vector3("m"), "Lower corner.").needed(), key("max", vector3("m"), "Upper corner.").needed(),
                cells(3), mesh_only("split", integer(between(5, 6)), "Tetrahedra of a cell.")});
}

Shape cylinder() {
  return table({key("from", vector3("m"), "Centre of one end.").needed(),
                key("to", vector3("m"), "Centre of the other end.").needed(),
                key("radius", number("m", above(0)), "Radius.").needed(), cells(2),
                mesh_only("angle", array(number("rad"), 2, 2), "Sector of the skin."),
                mesh_only("caps", boolean(), "Close the skin's ends.")});
}

Shape ellipsoid() {
  return table({key("center", vector3("m"), "Centre.").needed(),
                key("radii", vector3("m", above(0)), "Half axes along x, y and z.").needed(), cells(2)});
}

Shape rectangle() {
  return table(
      {key("origin", vector3("m"), "A corner.").needed(),
       key("edge_u", vector3("m"), "From `origin` to the next corner.").needed(),
       key("edge_v", vector3("m"), "From `origin` to the corner on the other side; not parallel to `edge_u`.").needed(),
       cells(2)});
}

Shape line() {
  return table({key("from", vector3("m"), "One end.").needed(), key("to", vector3("m"), "The other end.").needed()});
}

}  // namespace

Shape domain_schema() {
  return table(
      {key("box", box(), "An axis-aligned box."), key("cylinder", cylinder(), "A solid cylinder."),
       key("ellipsoid", ellipsoid(), "A solid ellipsoid."),
       key("file", text("a path"),
           "A mesh: Gmsh 2.2 or 4.1, VTK legacy, VTU, STL, OBJ or PLY. Closed surfaces and volume cells are solids; "
           "with "
           "`thickness`, triangles that bound no solid are sheets; with `radius`, its lines are lines. The path is "
           "relative to the scene file."),
       key("block", table({}), "A tapered block: eight corners.").not_yet(),
       key("rectangle", rectangle(), "A flat sheet between two edges; the body needs `thickness`."),
       key("annulus", table({}), "A flat ring.").not_yet(),
       key("line", line(), "A straight line; the body needs `radius`."),
       key("between", array(text(), 2, 2), "The space between the surfaces of two bodies.").not_yet(),
       key("where", reference("region", region_schema), "Parts of the surfaces of `between`.").not_yet(),
       key("as", choice({{"volume", ""}, {"sheet", ""}, {"strands", ""}}), "What `between` becomes.").not_yet()},
      {{{"box", "cylinder", "ellipsoid", "file", "block", "rectangle", "annulus", "line", "between"}}});
}

}  // namespace fascia::app

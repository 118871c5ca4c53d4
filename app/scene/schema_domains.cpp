#include "app/scene/schema.hpp"

namespace fascia::app {
namespace {

Key cells(std::size_t count, const std::string& meaning) {
  return key("cells", array(integer(between(1, 10000)), count, count),
             meaning + " Needed by `model = \"tetrahedra\"` and `\"hexahedra\"`, refused by others.");
}

Key split() {
  return key("split", integer(between(5, 6)),
             "Tetrahedra of a cell: 6 around its main diagonal, or 5, mirrored from cell to cell. Only for `model = "
             "\"tetrahedra\"`.")
      .defaults("6");
}

Key skin_only(const char* name, Shape shape, const char* doc) {
  return key(name, std::move(shape), doc).refused("is not used by a solid");
}

Shape box() {
  return table({key("min", vector3("m"), "Lower corner.").needed(), key("max", vector3("m"), "Upper corner.").needed(),
                cells(3, "Cells along x, y and z."), split()});
}

Shape block() {
  return table({key("corners", array(vector3("m"), 8, 8),
                    "Four corners of the lower face, counter-clockwise seen from above, then the four above them (the "
                    "order of a VTK hexahedron). The block is their trilinear interpolation.")
                    .needed(),
                cells(3, "Cells from corner 0 to corners 1, 3 and 4."), split()});
}

Shape cylinder() {
  return table({key("from", vector3("m"), "Centre of one end.").needed(),
                key("to", vector3("m"), "Centre of the other end.").needed(),
                key("radius", number("m", above(0)), "Radius.").needed(),
                cells(2, "Cells along the axis and around it, a multiple of 4."),
                skin_only("angle", array(number("rad"), 2, 2), "Sector of the skin."),
                skin_only("caps", boolean(), "Close the skin's ends.")});
}

Shape ellipsoid() {
  return table({key("center", vector3("m"), "Centre.").needed(),
                key("radii", vector3("m", above(0)), "Half axes along x, y and z.").needed(),
                cells(2, "Cells around, a multiple of 4, and layers between core and surface.")});
}

Shape rectangle() {
  return table(
      {key("origin", vector3("m"), "A corner.").needed(),
       key("edge_u", vector3("m"), "From `origin` to the next corner.").needed(),
       key("edge_v", vector3("m"), "From `origin` to the corner on the other side; not parallel to `edge_u`.").needed(),
       key("cells", array(integer(between(1, 10000)), 2, 2), "Cells along both edges.")
           .refused("is only for shells, which are not supported yet")});
}

Shape line() {
  return table({key("from", vector3("m"), "One end.").needed(), key("to", vector3("m"), "The other end.").needed()});
}

}  // namespace

Shape domain_schema() {
  return table(
      {key("box", box(), "An axis-aligned box."),
       key("block", block(), "A tapered block between eight corners; for tetrahedra and hexahedra."),
       key("cylinder", cylinder(), "A solid cylinder."), key("ellipsoid", ellipsoid(), "A solid ellipsoid."),
       key("file", text("a path"),
           "A mesh: Gmsh 2.2 or 4.1, VTK legacy, VTU, STL, OBJ or PLY. Closed surfaces and volume cells are solids; "
           "with "
           "`thickness`, triangles that bound no solid are sheets; with `radius`, its lines are lines. The path is "
           "relative to the scene file."),
       key("rectangle", rectangle(), "A flat sheet between two edges; the body needs `thickness`."),
       key("annulus", table({}), "A flat ring.").not_yet(),
       key("line", line(), "A straight line; the body needs `radius`."),
       key("between", array(text(), 2, 2), "The space between the surfaces of two bodies.").not_yet(),
       key("where", reference("region", region_schema), "Parts of the surfaces of `between`.").not_yet(),
       key("as", choice({{"volume", ""}, {"sheet", ""}, {"strands", ""}}), "What `between` becomes.").not_yet()},
      {{{"box", "block", "cylinder", "ellipsoid", "file", "rectangle", "annulus", "line", "between"}}});
}

}  // namespace fascia::app

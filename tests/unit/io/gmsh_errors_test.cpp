#include "core/geometry/surface.hpp"
#include "io/gmsh/gmsh.hpp"
#include "tests/unit/io/gmsh_samples.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <limits>
#include <random>

namespace fascia::io::gmsh_errors_test {
namespace {

std::string error_of(const std::string& text) {
  return samples::input_error([&] { parse_gmsh(text, "a.msh"); });
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t place = text.find(from);
  if (place == std::string::npos) throw std::runtime_error("nothing to replace: " + from);
  return text.replace(place, from.size(), to);
}

struct Case {
  const char* from;
  const char* to;
  const char* message;  ///< the beginning of it
};

TEST(GmshErrors, version_22_names_line_and_remedy) {
  const Case cases[] = {
      {"$MeshFormat", "$MeshForm", "a.msh:1: is no Gmsh mesh"},
      {"2.2 0 8", "4.0 0 8", "a.msh:2: version \"4.0\" of Gmsh's format is not supported; save as 4.1 or 2.2"},
      {"2.2 0 8", "2.2 2 8", "a.msh:2: the kind of file is 2"},
      {"2.2 0 8", "2.2 0 4", "a.msh:2: numbers of 4 bytes"},
      {"2 3 \"skin of it\"", "2 3 skin", "a.msh:9: the name of physical group 3 must stand in double quotes"},
      {"2 3 \"skin", "5 3 \"skin", "a.msh:9: the dimension of a physical group is 5"},
      {"$Nodes\n4", "$Nodes\n-4", "a.msh:12: the number of nodes is -4"},
      {"$Nodes\n4", "$Nodes\n4000000000000", "a.msh:12: the number of nodes is 4000000000000, but only"},
      {"$Nodes\n4", "$Nodes\n99999999999999999999", "a.msh:12: expected the number of nodes, found \"999"},
      {"$Nodes\n4", "$Nodes\n3", "a.msh:16: expected $EndNodes; the section holds more than it says"},
      {"$Nodes\n4", "$Nodes\n5", "a.msh:17: expected a node number, found \"$EndNodes\"; must be a whole number"},
      {"30 0 +1e0 0", "30 0 nan 0", "a.msh:15: expected a coordinate, found \"nan\"; must be a finite number"},
      {"30 0 +1e0 0", "30 0 -inf 0", "a.msh:15: expected a coordinate, found \"-inf\""},
      {"30 0 +1e0 0", "30 0 1e999 0", "a.msh:15: expected a coordinate, found \"1e999\""},
      {"30 0 +1e0 0", "30 0 0x1 0", "a.msh:15: expected a coordinate"},
      {"30 0 +1e0 0", "30 0 1", "a.msh:15: expected a coordinate, found the end of the line"},
      {"30 0 +1e0 0", "30 0 1 0 0", "a.msh:15: node 30 is followed by \"0\"; the line must end there"},
      {"30 0 +1e0 0", "10 0 1 0", "a.msh:15: node 10 appears twice"},
      {"$Elements\n6", "$Elements\n66666", "a.msh:19: the number of elements is 66666, but only"},
      {"$Elements\n6", "$Elements\n7", "a.msh:26: expected an element number, found \"$EndElements\""},
      {"5 4 2 7 1 10 20 30 40", "5 4 2 7 1 10 20 30 50", "a.msh:24: element 5 uses node 50, which the file does not"},
      {"5 4 2 7 1 10 20 30 40", "5 77 2 7 1 10 20 30 40", "a.msh:24: element type 77 is not supported"},
      {"5 4 2 7 1 10 20 30 40", "5 4 2 7 1 10 20 30", "a.msh:24: expected a node number, found the end of the line"},
      {"5 4 2 7 1 10 20 30 40", "5 4 -2 7 1 10 20 30 40", "a.msh:24: the number of tags is -2"},
      {"5 4 2 7 1 10 20 30 40", "5 4 2 7777777777 1 10 20 30 40",
       "a.msh:24: physical group 7777777777 is out of range"},
      {"$EndElements\n", "", "a.msh:26: expected $EndElements"},
      {"$EndComments", "", "a.msh:4: the section has no $EndComments"},
      {"$Comments", "Comments", "a.msh:4: expected a section"},
      {"$EndElements\n", "$EndElements\n$Nodes\n0\n$EndNodes\n", "a.msh:27: a second $Nodes section"},
  };
  for (const Case& c : cases) {
    const std::string e = error_of(replaced(samples::gmsh_22(), c.from, c.to));
    EXPECT_EQ(e.rfind(c.message, 0), 0u) << c.to << "\n  expected " << c.message << "\n  found    " << e;
    EXPECT_EQ(e.find('\n'), std::string::npos) << e;
  }
}

TEST(GmshErrors, version_41) {
  const Case cases[] = {
      {"1 0 1 1\n1 0 0", "-1 0 1 1\n1 0 0", "a.msh:9: a number of entities is -1"},
      {"1 1 1 1 7 1 1", "1 1 1 99999 7 1 1", "a.msh:12: the number of physical groups is 99999, but only"},
      {"2 4 10 40", "2 5 10 40", "a.msh:25: the nodes of the blocks add up to 4, not to 5"},
      {"2 4 10 40", "2 3 10 40", "a.msh:23: the number of nodes of a block is 1, but only 0 are left"},
      {"2 1 0 3\n", "4 1 0 3\n", "a.msh:16: the dimension of an entity is 4; must be 0 to 3"},
      {"3 1 4 1\n", "3 2 4 1\n", "a.msh:34: entity 2 of dimension 3 is not in $Entities"},
      {"3 1 4 1\n", "2 1 4 1\n", "a.msh:34: elements of dimension 3 in an entity of dimension 2"},
      {"$Entities", "$PartitionedEntities", "a.msh:8: the mesh is partitioned"},
      {"5 10 20 30 40", "5 10 20 30 41", "a.msh:35: element 5 uses node 41"},
  };
  for (const Case& c : cases) {
    const std::string e = error_of(replaced(samples::gmsh_41(), c.from, c.to));
    EXPECT_EQ(e.rfind(c.message, 0), 0u) << c.to << "\n  expected " << c.message << "\n  found    " << e;
  }
}

TEST(GmshErrors, version_1) {
  const Case cases[] = {
      {"$NOD", "NOD", "a.msh:1: is no Gmsh mesh: it must start with $MeshFormat (or $NOD, in version 1)"},
      {"30 0 +1e0 0", "30 0 1", "a.msh:5: expected a coordinate, found the end of the line"},
      {"5 4 7 1 4 10 20 30 40", "5 4 7 1 5 10 20 30 40",
       "a.msh:14: element 5 says that it has 5 nodes; its type has 4: correct the one or the other"},
      {"5 4 7 1 4 10 20 30 40", "5 4 7 1 4 10 20 30", "a.msh:14: expected a node number, found the end of the line"},
      {"5 4 7 1 4 10 20 30 40", "5 4 7 1 4 10 20 30 40 50", "a.msh:14: element 5 is followed by \"50\""},
      {"5 4 7 1 4 10 20 30 40", "5 77 7 1 4 10 20 30 40", "a.msh:14: element type 77 is not supported"},
      {"$ELM\n6", "$ELM\n7", "a.msh:16: expected an element number, found \"$ENDELM\""},
      {"$ELM\n6", "$ELM\n66666", "a.msh:9: the number of elements is 66666, but only"},
      {"$ENDELM\n", "", "a.msh:16: expected $ENDELM"},
  };
  for (const Case& c : cases) {
    const std::string e = error_of(replaced(samples::gmsh_1(), c.from, c.to));
    EXPECT_EQ(e.rfind(c.message, 0), 0u) << c.to << "\n  expected " << c.message << "\n  found    " << e;
  }
  EXPECT_EQ(error_of(samples::gmsh_1().substr(0, samples::gmsh_1().find("$ELM"))),
            "a.msh: the mesh has no $ELM section; the file is cut off or holds no mesh");
}

TEST(GmshErrors, binary_names_the_byte) {
  std::string text = samples::gmsh_22_binary();
  const std::size_t mark = std::string("$MeshFormat\n2.2 1 8\n").size();
  std::swap(text[mark], text[mark + 3]);
  const std::string e = error_of(text);
  EXPECT_EQ(e, "a.msh: byte " + std::to_string(mark) +
                   ": the bytes are in the order of another kind of machine; save as ASCII");

  text = samples::gmsh_22_binary();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::memcpy(text.data() + text.find("$Nodes\n4\n") + 9 + 4, &nan, sizeof(nan));
  EXPECT_NE(error_of(text).find("a coordinate is not finite"), std::string::npos);
}

TEST(GmshErrors, mesh_without_elements) {
  const std::string text = samples::gmsh_22();
  EXPECT_NE(error_of(text.substr(0, text.find("$Elements"))).find("no $Elements section"), std::string::npos);
  EXPECT_NE(error_of(text.substr(0, text.find("$Elements")) + "$Elements\n0\n$EndElements\n").find("has no cells"),
            std::string::npos);
}

/// Parses, and where that works makes the surface; only InputError may come out.
void survive(const std::string& text) {
  try {
    closed_surface(parse_gmsh(text, "a.msh"));
  } catch (const InputError& e) {
    EXPECT_EQ(std::string(e.what()).rfind("a.msh", 0), 0u) << e.what();
  }
}

TEST(GmshErrors, every_truncation_and_many_mutations) {
  std::mt19937 random(3);
  for (const std::string& text : {samples::gmsh_1(), samples::gmsh_22(), samples::gmsh_41(), samples::gmsh_22_binary(),
                                  samples::gmsh_41_binary()}) {
    const std::size_t last_line = text.rfind('\n');
    for (std::size_t length = 0; length < last_line; ++length)
      EXPECT_THROW(parse_gmsh(text.substr(0, length), "a.msh"), InputError) << length;
    for (int round = 0; round < 20000; ++round) {
      std::string mutated = text;
      for (int change = 0; change < 1 + round % 4; ++change)
        mutated[random() % mutated.size()] =
            round % 2 ? static_cast<char>(random() % 256) : "0123456789 -$.e\n"[random() % 16];
      survive(mutated);
    }
  }
}

}  // namespace
}  // namespace fascia::io::gmsh_errors_test

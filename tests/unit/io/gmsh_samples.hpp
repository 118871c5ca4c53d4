#pragma once

#include "core/geometry/mesh.hpp"

#include <cstring>
#include <string>

/// The unit cube's corner tetrahedron and its four faces, in groups "skin" and 7, as each kind of Gmsh file has it.
namespace fascia::samples {

inline std::string gmsh_22() {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
         "$Comments\nanything at all\n$EndComments\n"
         "$PhysicalNames\n1\n2 3 \"skin of it\"\n$EndPhysicalNames\n"
         "$Nodes\n4\n10 0 0 0\n20 1 0 0\n30 0 +1e0 0\n40 0 0 1\n$EndNodes\n"
         "$Elements\n6\n"
         "1 2 2 3 1 10 30 20\n2 2 2 3 1 10 20 40\n3 2 2 3 1 20 30 40\n4 2 2 3 1 10 40 30\n"
         "5 4 2 7 1 10 20 30 40\n6 15 2 0 1 10\n"
         "$EndElements\n";
}

/// Version 1 has no names of groups.
inline std::string gmsh_1() {
  return "$NOD\n4\n10 0 0 0\n20 1 0 0\n30 0 +1e0 0\n40 0 0 1\n$ENDNOD\n"
         "$ELM\n6\n"
         "1 2 3 1 3 10 30 20\n2 2 3 1 3 10 20 40\n3 2 3 1 3 20 30 40 \n4 2 3 1 3 10 40 30\n"
         "5 4 7 1 4 10 20 30 40\n6 15 0 1 1 10\n"
         "$ENDELM\n";
}

inline std::string gmsh_41() {
  return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
         "$PhysicalNames\n1\n2 3 \"skin of it\"\n$EndPhysicalNames\n"
         "$Entities\n1 0 1 1\n1 0 0 0 0\n1 0 0 0 1 1 1 1 3 0\n1 0 0 0 1 1 1 1 7 1 1\n$EndEntities\n"
         "$Nodes\n2 4 10 40\n2 1 0 3\n10\n20\n30\n0 0 0\n1 0 0\n0 1 0\n3 1 1 1\n40\n0 0 1 0.1 0.2 0.3\n$EndNodes\n"
         "$Elements\n3 6 1 6\n"
         "2 1 2 4\n1 10 30 20\n2 10 20 40\n3 20 30 40\n4 10 40 30\n"
         "3 1 4 1\n5 10 20 30 40\n"
         "0 1 15 1\n6 10\n"
         "$EndElements\n";
}

/// Appends numbers as bytes.
class Bytes {
 public:
  explicit Bytes(std::string text) : text_(std::move(text)) {}
  Bytes& text(const std::string& t) {
    text_ += t;
    return *this;
  }
  template <class T>
  Bytes& add(T value) {
    char buffer[sizeof(T)];
    std::memcpy(buffer, &value, sizeof(T));
    text_.append(buffer, sizeof(T));
    return *this;
  }
  Bytes& ints(std::initializer_list<std::int32_t> values) {
    for (const std::int32_t v : values) add(v);
    return *this;
  }
  Bytes& sizes(std::initializer_list<std::uint64_t> values) {
    for (const std::uint64_t v : values) add(v);
    return *this;
  }
  Bytes& numbers(std::initializer_list<double> values) {
    for (const double v : values) add(v);
    return *this;
  }
  const std::string& str() const { return text_; }

 private:
  std::string text_;
};

inline std::string gmsh_22_binary() {
  Bytes b("$MeshFormat\n2.2 1 8\n");
  b.ints({1}).text("\n$EndMeshFormat\n$PhysicalNames\n1\n2 3 \"skin of it\"\n$EndPhysicalNames\n$Nodes\n4\n");
  b.ints({10}).numbers({0, 0, 0}).ints({20}).numbers({1, 0, 0}).ints({30}).numbers({0, 1, 0});
  b.ints({40}).numbers({0, 0, 1}).text("\n$EndNodes\n$Elements\n6\n");
  b.ints({2, 4, 2}).ints({1, 3, 1, 10, 30, 20}).ints({2, 3, 1, 10, 20, 40});
  b.ints({3, 3, 1, 20, 30, 40}).ints({4, 3, 1, 10, 40, 30});
  b.ints({4, 1, 2}).ints({5, 7, 1, 10, 20, 30, 40}).ints({15, 1, 2}).ints({6, 0, 1, 10});
  return b.text("\n$EndElements\n").str();
}

inline std::string gmsh_41_binary() {
  Bytes b("$MeshFormat\n4.1 1 8\n");
  b.ints({1}).text("\n$EndMeshFormat\n$PhysicalNames\n1\n2 3 \"skin of it\"\n$EndPhysicalNames\n$Entities\n");
  b.sizes({1, 0, 1, 1}).ints({1}).numbers({0, 0, 0}).sizes({0});
  b.ints({1}).numbers({0, 0, 0, 1, 1, 1}).sizes({1}).ints({3}).sizes({0});
  b.ints({1}).numbers({0, 0, 0, 1, 1, 1}).sizes({1}).ints({7}).sizes({1}).ints({1});
  b.text("\n$EndEntities\n$Nodes\n").sizes({2, 4, 10, 40});
  b.ints({2, 1, 0}).sizes({3, 10, 20, 30}).numbers({0, 0, 0, 1, 0, 0, 0, 1, 0});
  b.ints({3, 1, 1}).sizes({1, 40}).numbers({0, 0, 1, 0.1, 0.2, 0.3}).text("\n$EndNodes\n$Elements\n");
  b.sizes({3, 6, 1, 6}).ints({2, 1, 2}).sizes({4}).sizes({1, 10, 30, 20, 2, 10, 20, 40, 3, 20, 30, 40, 4, 10, 40, 30});
  b.ints({3, 1, 4}).sizes({1}).sizes({5, 10, 20, 30, 40}).ints({0, 1, 15}).sizes({1}).sizes({6, 10});
  return b.text("\n$EndElements\n").str();
}

}  // namespace fascia::samples

#include "io/mesh/isolated.hpp"

#include "core/base/errors.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

namespace fascia::io {
namespace {

// ---------------------------------------------------------------------------------------------- a mesh as bytes
class Packer {
 public:
  template <class T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(values.size());
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  void add(const std::string& text) {
    add(text.size());
    bytes_.append(text);
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : bytes_(bytes) {}

  template <class T>
  void get(T& value) {
    copy(&value, sizeof(T));
  }
  template <class T>
  void get(std::vector<T>& values) {
    std::size_t size = 0;
    get(size);
    if (size > bytes_.size() / sizeof(T)) throw std::length_error("cut off");
    values.resize(size);
    copy(values.data(), size * sizeof(T));
  }
  void get(std::string& text) {
    std::size_t size = 0;
    get(size);
    if (size > bytes_.size()) throw std::length_error("cut off");
    text = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
  }

 private:
  void copy(void* target, std::size_t size) {
    if (size > bytes_.size()) throw std::length_error("cut off");
    if (size > 0) std::memcpy(target, bytes_.data(), size);
    bytes_.remove_prefix(size);
  }
  std::string_view bytes_;
};

std::string pack(const Mesh& mesh) {
  Packer packer;
  packer.add(mesh.points);
  packer.add(mesh.point_file_number);
  packer.add(mesh.blocks.size());
  for (const CellBlock& block : mesh.blocks) {
    packer.add(block.type);
    packer.add(block.nodes);
    packer.add(block.group);
    packer.add(block.file_number);
    packer.add(block.mid_nodes_per_cell);
    packer.add(block.mid_nodes);
  }
  packer.add(mesh.groups.size());
  for (const MeshGroup& group : mesh.groups) {
    packer.add(group.name);
    packer.add(group.number);
    packer.add(group.dimension);
  }
  packer.add(mesh.messages.size());
  for (const std::string& message : mesh.messages) packer.add(message);
  return packer.take();
}

Mesh unpack(std::string_view bytes) {
  Unpacker unpacker(bytes);
  Mesh mesh;
  unpacker.get(mesh.points);
  unpacker.get(mesh.point_file_number);
  std::size_t blocks = 0;
  unpacker.get(blocks);
  for (std::size_t b = 0; b < blocks; ++b) {
    CellBlock& block = mesh.blocks.emplace_back();
    unpacker.get(block.type);
    unpacker.get(block.nodes);
    unpacker.get(block.group);
    unpacker.get(block.file_number);
    unpacker.get(block.mid_nodes_per_cell);
    unpacker.get(block.mid_nodes);
  }
  std::size_t groups = 0;
  unpacker.get(groups);
  for (std::size_t g = 0; g < groups; ++g) {
    MeshGroup& group = mesh.groups.emplace_back();
    unpacker.get(group.name);
    unpacker.get(group.number);
    unpacker.get(group.dimension);
  }
  std::size_t messages = 0;
  unpacker.get(messages);
  for (std::size_t m = 0; m < messages; ++m) unpacker.get(mesh.messages.emplace_back());
  return mesh;
}

// ---------------------------------------------------------------------------------------------- processes
constexpr char has_mesh = 'M', has_message = 'E';

bool write_all(int pipe, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(pipe, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) return false;
    if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

std::string read_all(int pipe) {
  std::string bytes;
  std::vector<char> buffer(std::size_t{1} << 16);
  while (true) {
    const ssize_t size = read(pipe, buffer.data(), buffer.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return bytes;
    bytes.append(buffer.data(), static_cast<std::size_t>(size));
  }
}

/// No output, no core file, no endless loop, no signal that waits for the parent's threads.
void confine() {
  sigset_t none_blocked;
  sigemptyset(&none_blocked);
  sigprocmask(SIG_SETMASK, &none_blocked, nullptr);
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
  const rlimit none{0, 0}, seconds{600, 600};
  setrlimit(RLIMIT_CORE, &none);
  setrlimit(RLIMIT_CPU, &seconds);
}

[[noreturn]] void run_child(int pipe, const std::function<Mesh()>& read) {
  confine();
  bool sent = false;
  try {
    const std::string mesh = pack(read());
    sent = write_all(pipe, std::string(1, has_mesh)) && write_all(pipe, mesh);
  } catch (const std::exception& e) {
    sent = write_all(pipe, has_message + std::string(e.what()));
  }
  _exit(sent ? 0 : 1);
}

/// Waits for the child; true where it ended well.
bool ended_well(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return false;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

[[noreturn]] void fail_start(const std::string& file, int error) {
  throw FileError(file + ": cannot be read: no process can be started for it: " +
                  std::generic_category().message(error) + "; end other programs");
}

}  // namespace

Mesh read_isolated(const std::string& file, const std::function<Mesh()>& read) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) fail_start(file, errno);
  signal(SIGCHLD, SIG_DFL);  // where the caller had it ignored, nobody could learn how the child ends
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    run_child(ends[1], read);
  }
  const int error = errno;
  close(ends[1]);
  const std::string answer = child < 0 ? std::string() : read_all(ends[0]);
  close(ends[0]);
  if (child < 0) fail_start(file, error);

  if (!ended_well(child) || answer.empty())
    throw InputError(file + ": its reader breaks down on it; the file is damaged or cut off: write it again");
  const std::string_view content = std::string_view(answer).substr(1);
  if (answer[0] == has_message) throw InputError(std::string(content));
  try {
    Mesh mesh = unpack(content);
    mesh.file = file;
    return mesh;
  } catch (const std::length_error&) {
    throw InputError(file + ": its reader breaks down on it; the file is damaged or cut off: write it again");
  }
}

}  // namespace fascia::io

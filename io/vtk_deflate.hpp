#pragma once

#include "core/base/thread_pool.hpp"

#include <vtkZLibDataCompressor.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

struct libdeflate_compressor;

namespace fascia::io {

/// Compresses what VTK writes as zlib's fastest level does, to the same size in less than half the time. Files name
/// VTK's own class, and are read as if that had made them.
///
/// VTK asks for one block after another. Of an array that it is told of, it compresses the next blocks together, on
/// all threads: they are the same, whatever their number.
class VtkDeflate : public vtkZLibDataCompressor {
 public:
  /// @throws std::bad_alloc
  static VtkDeflate* New();  // NOLINT(readability-identifier-naming): VTK's name for it

  /// Says which arrays VTK will ask for, block by block. They and the pool must outlive it.
  void look_ahead(std::vector<std::span<const unsigned char>> arrays, ThreadPool& pool);

  std::size_t GetMaximumCompressionSpace(std::size_t size) override;

 protected:
  VtkDeflate();
  ~VtkDeflate() override;

  std::size_t CompressBuffer(const unsigned char* data, std::size_t size, unsigned char* compressed,
                             std::size_t space) override;

 private:
  struct Free {
    void operator()(libdeflate_compressor* compressor) const;
  };
  using Compressor = std::unique_ptr<libdeflate_compressor, Free>;
  /// Blocks of one array that follow one another, compressed.
  struct Ahead {
    const unsigned char* data = nullptr;
    std::size_t block = 0, size = 0;                 ///< bytes of a block, and of all, the last of which may be shorter
    std::vector<std::vector<unsigned char>> blocks;  ///< room for each
    std::vector<std::size_t> length;                 ///< of each, once compressed; 0: none
  };
  bool compress_ahead(const unsigned char* data, std::size_t size);

  std::vector<Compressor> compressors_;  ///< of each thread
  std::vector<std::span<const unsigned char>> arrays_;
  ThreadPool* pool_ = nullptr;
  Ahead ahead_;
};

}  // namespace fascia::io

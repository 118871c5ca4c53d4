#include "io/vtk_deflate.hpp"

#include "core/base/index.hpp"

#include <libdeflate.h>
#include <vtkSetGet.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

namespace fascia::io {

namespace {

constexpr int kFastest = 1;
constexpr std::size_t kBlocksOfThread = 4;  // that are compressed ahead together

}  // namespace

VtkDeflate* VtkDeflate::New() {
  auto* made = new VtkDeflate;
  made->InitializeObjectBase();
  if (!made->compressors_.front()) {
    made->Delete();
    throw std::bad_alloc();
  }
  return made;
}

void VtkDeflate::Free::operator()(libdeflate_compressor* compressor) const { libdeflate_free_compressor(compressor); }

VtkDeflate::VtkDeflate() { compressors_.emplace_back(libdeflate_alloc_compressor(kFastest)); }

VtkDeflate::~VtkDeflate() = default;

void VtkDeflate::look_ahead(std::vector<std::span<const unsigned char>> arrays, ThreadPool& pool) {
  arrays_ = std::move(arrays);
  pool_ = &pool;
  while (compressors_.size() < at(pool.size())) {
    compressors_.emplace_back(libdeflate_alloc_compressor(kFastest));
    if (!compressors_.back()) throw std::bad_alloc();
  }
}

/// Where the block lies in an array that is known, and others follow it.
bool VtkDeflate::compress_ahead(const unsigned char* data, std::size_t size) {
  if (pool_ == nullptr || pool_->size() == 1) return false;
  const auto array = std::find_if(arrays_.begin(), arrays_.end(), [&](std::span<const unsigned char> a) {
    return data >= a.data() && data + size < a.data() + a.size();
  });
  if (array == arrays_.end()) return false;
  const auto left = static_cast<std::size_t>(array->data() + array->size() - data);
  const std::size_t threads = compressors_.size(),
                    count = std::min((left + size - 1) / size, threads * kBlocksOfThread);
  ahead_.data = data;
  ahead_.block = size;
  ahead_.size = std::min(left, count * size);
  ahead_.length.assign(count, 0);
  ahead_.blocks.resize(std::max(ahead_.blocks.size(), count));
  for (std::size_t b = 0; b < count; ++b) ahead_.blocks[b].resize(GetMaximumCompressionSpace(size));
  pool_->for_chunks(static_cast<int>(threads), [&](int thread) {
    for (std::size_t b = at(thread); b < count; b += threads)
      ahead_.length[b] =
          libdeflate_zlib_compress(compressors_[at(thread)].get(), data + b * size, std::min(size, left - b * size),
                                   ahead_.blocks[b].data(), ahead_.blocks[b].size());
  });
  return true;
}

std::size_t VtkDeflate::GetMaximumCompressionSpace(std::size_t size) {
  return libdeflate_zlib_compress_bound(compressors_.front().get(), size);
}

std::size_t VtkDeflate::CompressBuffer(const unsigned char* data, std::size_t size, unsigned char* compressed,
                                       std::size_t space) {
  const auto is_ahead = [&] {
    return data >= ahead_.data && data < ahead_.data + ahead_.size &&
           size == std::min(ahead_.block, static_cast<std::size_t>(ahead_.data + ahead_.size - data)) &&
           static_cast<std::size_t>(data - ahead_.data) % ahead_.block == 0;
  };
  std::size_t length = 0;
  if (is_ahead() || compress_ahead(data, size)) {
    const std::size_t block = static_cast<std::size_t>(data - ahead_.data) / ahead_.block;
    length = ahead_.length[block];
    if (length > space) length = 0;
    std::memcpy(compressed, ahead_.blocks[block].data(), length);
  } else {
    length = libdeflate_zlib_compress(compressors_.front().get(), data, size, compressed, space);
  }
  if (length == 0) vtkErrorMacro("a block of " << size << " bytes cannot be compressed");
  return length;
}

}  // namespace fascia::io

#include "io/vtk_deflate.hpp"

#include <libdeflate.h>
#include <vtkSetGet.h>

#include <new>

namespace fascia::io {

namespace {

constexpr int kFastest = 1;

}  // namespace

VtkDeflate* VtkDeflate::New() {
  auto* made = new VtkDeflate;
  made->InitializeObjectBase();
  if (!made->compressor_) {
    made->Delete();
    throw std::bad_alloc();
  }
  return made;
}

void VtkDeflate::Free::operator()(libdeflate_compressor* compressor) const { libdeflate_free_compressor(compressor); }

VtkDeflate::VtkDeflate() : compressor_(libdeflate_alloc_compressor(kFastest)) {}

VtkDeflate::~VtkDeflate() = default;

std::size_t VtkDeflate::GetMaximumCompressionSpace(std::size_t size) {
  return libdeflate_zlib_compress_bound(compressor_.get(), size);
}

std::size_t VtkDeflate::CompressBuffer(const unsigned char* data, std::size_t size, unsigned char* compressed,
                                       std::size_t space) {
  const std::size_t length = libdeflate_zlib_compress(compressor_.get(), data, size, compressed, space);
  if (length == 0) vtkErrorMacro("a block of " << size << " bytes cannot be compressed");
  return length;
}

}  // namespace fascia::io

#include "victorious/object/mesh/assimp_io.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include <assimp/IOStream.hpp>

namespace victorious {
namespace {

class BytesStream : public Assimp::IOStream {
 public:
  explicit BytesStream(std::string bytes) : bytes_(std::move(bytes)) {}

  std::size_t Read(void* buffer, std::size_t size, std::size_t count) override {
    if (size == 0) return 0;
    const std::size_t items = std::min(count, (bytes_.size() - at_) / size);
    std::memcpy(buffer, bytes_.data() + at_, items * size);
    at_ += items * size;
    return items;
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    const std::size_t base = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? at_ : bytes_.size();
    const std::size_t target = base + offset;  // unsigned: a negative offset wraps around correctly
    if (target > bytes_.size()) return aiReturn_FAILURE;
    at_ = target;
    return aiReturn_SUCCESS;
  }
  [[nodiscard]] std::size_t Tell() const override { return at_; }
  [[nodiscard]] std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

}  // namespace

bool CadFolderIo::Exists(const char* name) const { return name == folder_.name() || folder_.Find(name).has_value(); }

Assimp::IOStream* CadFolderIo::Open(const char* name, const char* mode) {
  if (std::strpbrk(mode, "wa+") != nullptr) return nullptr;
  auto bytes = folder_.Read(name);
  return bytes ? std::make_unique<BytesStream>(*std::move(bytes)).release() : nullptr;
}

void CadFolderIo::Close(Assimp::IOStream* stream) { delete stream; }

}  // namespace victorious

// Values as bytes, for what one build of the program writes and the same build reads: numbers keep every bit.
//
//   ByteWriter writer;
//   writer.Put(frame);                        // little-endian
//   writer.PutOptional(range_m);
//   const std::vector<std::byte> bytes = writer.Take();
//   ByteReader reader(bytes);                 // which outlive it
//   const auto frame = reader.Get<std::int64_t>();
//   if (!reader.IsAtEnd()) …                  // too few bytes, too many, or a value out of range
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace victorious {

static_assert(std::endian::native == std::endian::little);

class ByteWriter {
 public:
  template <typename T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void Put(const T& value) {
    Append(std::as_bytes(std::span(&value, 1)));
  }
  template <typename T>
  void PutOptional(const std::optional<T>& value) {
    if (PutHas(value)) Put(*value);
  }
  /// Whether there is a value, which the caller then writes.
  template <typename T>
  bool PutHas(const std::optional<T>& value) {
    Put(value.has_value());
    return value.has_value();
  }
  /// The number of items, then their bytes. T has no padding.
  template <typename T>
    requires std::is_trivially_copyable_v<T>
  void PutItems(std::span<const T> items) {
    Put(std::uint64_t{items.size()});
    Append(std::as_bytes(items));
  }

  /// The number of bytes, then the bytes.
  void PutText(std::string_view text) { PutItems(std::span<const char>(text)); }

  [[nodiscard]] std::vector<std::byte> Take() { return std::move(bytes_); }
  /// The same as Take, as a text: a request to another process.
  [[nodiscard]] std::string TakeText() {
    const std::vector<std::byte> bytes = Take();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

 private:
  void Append(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

  std::vector<std::byte> bytes_;
};

/// Safe for any bytes: reads 0 beyond the end, and remembers that and every other fault.
class ByteReader {
 public:
  /// @param bytes  outlive it
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  explicit ByteReader(std::vector<std::byte>&&) = delete;

  template <typename T>
    requires std::is_arithmetic_v<T>
  T Get() {
    if constexpr (std::is_same_v<T, bool>) {
      const auto value = Get<std::uint8_t>();
      if (value > 1) failed_ = true;
      return value == 1;
    } else {
      T value{};
      Copy(std::as_writable_bytes(std::span(&value, 1)));
      return value;
    }
  }
  /// An enumerator from the first, 0, to `last`.
  template <typename T>
    requires std::is_enum_v<T>
  T GetEnum(T last) {
    const auto value = Get<std::underlying_type_t<T>>();
    if (value < 0 || value > std::to_underlying(last)) {
      failed_ = true;
      return T{};
    }
    return static_cast<T>(value);
  }
  template <typename T>
  std::optional<T> GetOptional() {
    return Get<bool>() ? std::optional(Get<T>()) : std::nullopt;
  }
  /// A number of items of at least `item_bytes` each, that the rest can hold.
  std::size_t GetCount(std::size_t item_bytes) {
    const auto count = Get<std::uint64_t>();
    if (count > bytes_.size() / item_bytes) failed_ = true;
    return failed_ ? 0 : static_cast<std::size_t>(count);
  }
  /// What PutItems wrote.
  template <typename T>
  std::vector<T> GetItems() {
    std::vector<T> items(GetCount(sizeof(T)));
    Copy(std::as_writable_bytes(std::span(items)));
    return items;
  }

  /// What PutText wrote.
  std::string GetText() {
    std::string text(GetCount(1), '\0');
    Copy(std::as_writable_bytes(std::span(text)));
    return text;
  }

  /// True if all bytes were read, and no more, without a fault.
  [[nodiscard]] bool IsAtEnd() const { return !failed_ && bytes_.empty(); }
  [[nodiscard]] bool HasFailed() const { return failed_; }

 private:
  void Copy(std::span<std::byte> to) {
    if (failed_ || to.size() > bytes_.size()) {
      failed_ = true;
      return;
    }
    if (!to.empty()) std::memcpy(to.data(), bytes_.data(), to.size());
    bytes_ = bytes_.subspan(to.size());
  }

  std::span<const std::byte> bytes_;
  bool failed_ = false;
};

}  // namespace victorious

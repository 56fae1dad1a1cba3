#include "victorious/store/postgres/values.h"

#include <bit>
#include <charconv>

#include <libpq-fe.h>

#include "victorious/base/check.h"
#include "victorious/store/postgres/text.h"

namespace victorious::postgres {
namespace {

// The ids of types in PostgreSQL's catalogue (pg_type.dat); they never change.
constexpr unsigned kByteaType = 17;
constexpr unsigned kBigintType = 20;
constexpr unsigned kTextType = 25;
constexpr unsigned kDoubleType = 701;

template <typename Unsigned>
void AppendBigEndian(Unsigned value, std::string& bytes) {
  for (int shift = 8 * (static_cast<int>(sizeof(Unsigned)) - 1); shift >= 0; shift -= 8) {
    bytes += static_cast<char>(value >> shift & 0xFFU);
  }
}

template <typename Unsigned>
std::string BigEndian(Unsigned value) {
  std::string bytes;
  AppendBigEndian(value, bytes);
  return bytes;
}

std::uint64_t ReadBigEndian(std::span<const std::byte> bytes) {
  std::uint64_t value = 0;
  for (const std::byte byte : bytes) value = value << 8 | std::to_integer<std::uint64_t>(byte);
  return value;
}

}  // namespace

BoundValues::Value& BoundValues::At(int parameter) {
  const auto position = static_cast<std::size_t>(parameter) - 1;
  if (position >= values_.size()) values_.resize(position + 1);
  return values_[position];
}

void BoundValues::BindAt(int parameter, std::int64_t value) {
  At(parameter) = {kBigintType, BigEndian(static_cast<std::uint64_t>(value))};
}

void BoundValues::BindAt(int parameter, double value) {
  At(parameter) = {kDoubleType, BigEndian(std::bit_cast<std::uint64_t>(value))};
}

void BoundValues::BindAt(int parameter, std::string_view value) { At(parameter) = {kTextType, EncodeText(value)}; }

void BoundValues::BindAt(int parameter, std::span<const std::byte> value) {
  At(parameter) = {kByteaType, std::string(reinterpret_cast<const char*>(value.data()), value.size())};
}

void BoundValues::BindAt(int parameter, std::nullopt_t) { At(parameter) = {}; }

// PostgreSQL's manual, COPY, "Binary Format": signature, flags, length of the header's extension.
CopyRows::CopyRows() : bytes_("PGCOPY\n\377\r\n\0\0\0\0\0\0\0\0\0", 19) {}

void CopyRows::Add(const BoundValues& row) {
  ++rows_;
  AppendBigEndian(static_cast<std::uint16_t>(row.values().size()), bytes_);
  for (const BoundValues::Value& value : row.values()) {
    AppendBigEndian(value.bytes ? static_cast<std::uint32_t>(value.bytes->size()) : ~std::uint32_t{0}, bytes_);
    if (value.bytes) bytes_ += *value.bytes;
  }
}

void Result::Clear::operator()(pg_result* result) const { PQclear(result); }

int Result::RowCount() const { return PQntuples(result_.get()); }

std::int64_t Result::Changes() const {
  const std::string_view text = PQcmdTuples(result_.get());
  std::int64_t changes = 0;
  std::from_chars(text.data(), text.data() + text.size(), changes);
  return changes;
}

bool Result::IsNull(int column) const {
  VICTORIOUS_CHECK(column < PQnfields(result_.get()));
  return PQgetisnull(result_.get(), row_, column) != 0;
}

std::span<const std::byte> Result::Blob(int column) const {
  VICTORIOUS_CHECK(column < PQnfields(result_.get()));
  return {reinterpret_cast<const std::byte*>(PQgetvalue(result_.get(), row_, column)),
          static_cast<std::size_t>(PQgetlength(result_.get(), row_, column))};
}

std::int64_t Result::Integer(int column) const {
  if (IsNull(column)) return 0;
  const auto bytes = Blob(column);
  VICTORIOUS_CHECK(bytes.size() == 8 || bytes.size() == 1);  // bigint, boolean
  return static_cast<std::int64_t>(ReadBigEndian(bytes));
}

double Result::Real(int column) const {
  if (IsNull(column)) return 0;
  VICTORIOUS_CHECK(PQftype(result_.get(), column) == kDoubleType);
  return std::bit_cast<double>(ReadBigEndian(Blob(column)));
}

std::string Result::Text(int column) const {
  const auto bytes = Blob(column);
  return DecodeText({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace victorious::postgres

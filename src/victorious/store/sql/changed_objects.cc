#include "victorious/store/sql/changed_objects.h"

#include <algorithm>
#include <bit>
#include <bitset>

#include "victorious/store/sql/records.h"

namespace victorious::sql {
namespace {

// Takes the values that a row of an object would be written with, and compares them with those of a row.
class RowComparison final : public Parameters {
 public:
  explicit RowComparison(const Row& row) : row_(row) {}

  [[nodiscard]] bool IsEqual() const { return is_equal_.all(); }

  using Parameters::BindAt;
  void BindAt(int parameter, std::int64_t value) override {
    Set(parameter, !row_.IsNull(parameter - 1) && row_.Integer(parameter - 1) == value);
  }
  void BindAt(int parameter, double value) override {
    Set(parameter, !row_.IsNull(parameter - 1) &&
                       std::bit_cast<std::uint64_t>(row_.Real(parameter - 1)) == std::bit_cast<std::uint64_t>(value));
  }
  void BindAt(int parameter, std::string_view value) override {
    Set(parameter, !row_.IsNull(parameter - 1) && row_.Text(parameter - 1) == value);
  }
  void BindAt(int parameter, std::span<const std::byte> value) override {
    Set(parameter, !row_.IsNull(parameter - 1) && std::ranges::equal(row_.Blob(parameter - 1), value));
  }
  void BindAt(int parameter, std::nullopt_t /*null*/) override { Set(parameter, row_.IsNull(parameter - 1)); }

 private:
  void Set(int parameter, bool is_equal) { is_equal_[static_cast<std::size_t>(parameter - 1)] = is_equal; }

  const Row& row_;
  std::bitset<static_cast<std::size_t>(kObjectColumns.Size())> is_equal_;
};

}  // namespace

ChangedObjects::ChangedObjects(std::span<const ObjectRecord> objects) : all_(objects) {
  changed_.reserve(objects.size());
  object_of_.reserve(objects.size());
  for (const ObjectRecord& object : objects) {
    changed_[object.id] = &object;
    for (const std::int64_t tracklet : object.tracklets) object_of_[tracklet] = object.id;
  }
}

void ChangedObjects::Compare(const Row& object) {
  const auto made = changed_.find(object.Integer(kObjectColumns.Index("id")));
  if (made == changed_.end()) return;
  RowComparison comparison(object);
  BindObject(*made->second, comparison);
  if (comparison.IsEqual()) changed_.erase(made);
}

void ChangedObjects::CompareTracklet(const Row& tracklet) {
  const auto made = object_of_.find(tracklet.Integer(0));
  if (made == object_of_.end()) return;
  if (tracklet.IsNull(1) || tracklet.Integer(1) != made->second) members_.push_back({made->first, made->second});
}

std::vector<const ObjectRecord*> ChangedObjects::objects() const {
  std::vector<const ObjectRecord*> changed;
  for (const ObjectRecord& object : all_) {
    const auto found = changed_.find(object.id);
    if (found != changed_.end() && found->second == &object) changed.push_back(&object);
  }
  return changed;
}

}  // namespace victorious::sql

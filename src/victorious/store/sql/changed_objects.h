// What of the objects that data association made differs from the stored rows: PutObjects writes only that.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "victorious/store/index_store.h"
#include "victorious/store/sql/row.h"

namespace victorious::sql {

class ChangedObjects {
 public:
  /// @param objects  must outlive it
  explicit ChangedObjects(std::span<const ObjectRecord> objects);

  /// Compares with a stored object. Columns: kObjectColumns.
  void Compare(const Row& object);
  /// Compares with a stored tracklet. Columns: its id, that of its object.
  void CompareTracklet(const Row& tracklet);

  /// The objects without an equal row, after all rows were compared, in the order given.
  [[nodiscard]] std::vector<const ObjectRecord*> objects() const;

  struct Member {
    std::int64_t tracklet = 0;
    std::int64_t object = 0;
  };
  /// The stored tracklets that belong to another object than the stored one.
  [[nodiscard]] const std::vector<Member>& members() const { return members_; }

 private:
  std::span<const ObjectRecord> all_;
  std::unordered_map<std::int64_t, const ObjectRecord*> changed_;  // by id
  std::unordered_map<std::int64_t, std::int64_t> object_of_;       // by tracklet
  std::vector<Member> members_;
};

}  // namespace victorious::sql

#include "victorious/store/postgres/postgres_segment_store.h"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/enum_text.h"
#include "victorious/store/postgres/migrations.h"

namespace victorious::postgres {
namespace {

constexpr auto kSegmentStateTexts = std::to_array<EnumText<SegmentState>>(
    {{SegmentState::kOpen, "open"}, {SegmentState::kDone, "done"}, {SegmentState::kQuarantined, "quarantined"}});

class PostgresSegmentStore final : public SegmentStore {
 public:
  explicit PostgresSegmentStore(std::unique_ptr<Connection> connection) : connection_(std::move(connection)) {}

  [[nodiscard]] Status Put(const VideoCut& cut, std::span<const std::byte> prepared) override;
  [[nodiscard]] Expected<std::optional<VideoCut>> Find(std::int64_t video) override;
  [[nodiscard]] Expected<std::vector<std::byte>> Prepared(std::int64_t video) override;
  [[nodiscard]] Status Complete(std::int64_t video, const std::string& plan, FrameInterval frames,
                                std::span<const std::byte> results) override;
  [[nodiscard]] Status VisitResults(
      std::int64_t video, const std::function<Status(FrameInterval, std::span<const std::byte>)>& visit) override;
  [[nodiscard]] Status SetWhole(std::int64_t video, const std::string& plan) override;
  [[nodiscard]] Status GiveUp(std::int64_t video, FrameInterval frames, const std::string& reason) override;
  [[nodiscard]] Status Finish(std::int64_t video, const std::string& plan, std::span<const std::int64_t> models,
                              std::span<const CoverageGap> gaps) override;
  [[nodiscard]] Expected<std::vector<CoverageGap>> Gaps() override;

 private:
  std::unique_ptr<Connection> connection_;
};

Status PostgresSegmentStore::Put(const VideoCut& cut, std::span<const std::byte> prepared) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kShared));
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Query("DELETE FROM video_cuts WHERE video_id = ? AND plan <> ?", cut.video, cut.plan));
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result added,
      connection_->Query("INSERT INTO video_cuts (video_id, plan, step, is_whole, prepared) VALUES (?, ?, ?, ?::bigint "
                         "<> 0, ?) ON CONFLICT (video_id) DO NOTHING",
                         cut.video, cut.plan, cut.step, cut.is_whole ? 1 : 0, prepared));
  if (added.Changes() == 1) {
    for (const Segment& segment : cut.segments) {
      VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
          "INSERT INTO segments (video_id, from_frame, to_frame, state, reason) VALUES (?, ?, ?, ?, ?)", cut.video,
          segment.frames.from, segment.frames.to, ToText(kSegmentStateTexts, segment.state), segment.reason));
    }
  }
  return transaction.Commit();
}

Expected<std::optional<VideoCut>> PostgresSegmentStore::Find(std::int64_t video) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result found, connection_->Query("SELECT plan, step, is_whole FROM video_cuts WHERE video_id = ?", video));
  if (!found.Next()) return std::nullopt;
  VideoCut cut{.video = video, .plan = found.Text(0), .step = found.Integer(1), .is_whole = found.Integer(2) != 0};
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result rows,
      connection_->Query(
          "SELECT from_frame, to_frame, state, reason FROM segments WHERE video_id = ? ORDER BY from_frame", video));
  while (rows.Next()) {
    const std::optional<SegmentState> state = FromText(kSegmentStateTexts, rows.Text(2));
    if (!state) return std::unexpected(sql::DamagedIndex(connection_->name(), "a segment of an unknown state"));
    cut.segments.push_back({{rows.Integer(0), rows.Integer(1)}, *state, rows.Text(3)});
  }
  return cut;
}

Expected<std::vector<std::byte>> PostgresSegmentStore::Prepared(std::int64_t video) {
  VICTORIOUS_ASSIGN_OR_RETURN(Result row,
                              connection_->Query("SELECT prepared FROM video_cuts WHERE video_id = ?", video));
  if (!row.Next()) {
    return Fail(ErrorCode::kNotFound,
                fmt::format("{}: video {} is not cut into segments (any more)", connection_->name(), video));
  }
  const std::span<const std::byte> bytes = row.Blob(0);
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

Status PostgresSegmentStore::Complete(std::int64_t video, const std::string& plan, FrameInterval frames,
                                      std::span<const std::byte> results) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kShared));
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result found,
      connection_->Query("SELECT s.state FROM segments s JOIN video_cuts c USING (video_id) WHERE s.video_id = ? AND "
                         "c.plan = ? AND s.from_frame = ? AND s.to_frame = ? FOR UPDATE",
                         video, plan, frames.from, frames.to));
  if (!found.Next()) {
    return Fail(ErrorCode::kConflict,
                fmt::format("{}: frames {} to {} of video {} are no segment any more: another process cut the video "
                            "anew",
                            connection_->name(), frames.from, frames.to - 1, video));
  }
  if (found.Text(0) != ToText(kSegmentStateTexts, SegmentState::kDone)) {
    VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
        "UPDATE segments SET state = 'done', reason = '', results = ? WHERE video_id = ? AND from_frame = ?", results,
        video, frames.from));
  }
  return transaction.Commit();
}

Status PostgresSegmentStore::VisitResults(
    std::int64_t video, const std::function<Status(FrameInterval, std::span<const std::byte>)>& visit) {
  std::int64_t next_frame = 0;
  // One statement a segment, not a cursor: the visit writes, through another connection, for minutes.
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Result row, connection_->Query("SELECT from_frame, to_frame, results FROM segments WHERE video_id = ? AND "
                                       "state = 'done' AND from_frame >= ? ORDER BY from_frame LIMIT 1",
                                       video, next_frame));
    if (!row.Next()) return {};
    next_frame = row.Integer(1);
    VICTORIOUS_RETURN_IF_ERROR(visit({row.Integer(0), row.Integer(1)}, row.Blob(2)));
  }
}

Status PostgresSegmentStore::SetWhole(std::int64_t video, const std::string& plan) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result updated,
      connection_->Write("UPDATE video_cuts SET is_whole = true WHERE video_id = ? AND plan = ?", video, plan));
  return {};
}

Status PostgresSegmentStore::GiveUp(std::int64_t video, FrameInterval frames, const std::string& reason) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kShared));
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result found,
      connection_->Query("SELECT c.step FROM segments s JOIN video_cuts c USING (video_id) WHERE s.video_id = ? AND "
                         "s.from_frame = ? AND s.to_frame = ? AND s.state = 'open' FOR UPDATE",
                         video, frames.from, frames.to));
  if (!found.Next()) return transaction.Commit();
  const std::optional<std::int64_t> middle = MiddleOf(frames, found.Integer(0));
  if (middle) {
    VICTORIOUS_RETURN_IF_ERROR(
        connection_->Query("UPDATE segments SET to_frame = ? WHERE video_id = ? AND "
                           "from_frame = ?",
                           *middle, video, frames.from));
    VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
        "INSERT INTO segments (video_id, from_frame, to_frame) VALUES (?, ?, ?)", video, *middle, frames.to));
  } else {
    VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
        "UPDATE segments SET state = 'quarantined', reason = ? WHERE video_id = ? AND from_frame = ?", reason, video,
        frames.from));
  }
  return transaction.Commit();
}

Status PostgresSegmentStore::Finish(std::int64_t video, const std::string& plan, std::span<const std::int64_t> models,
                                    std::span<const CoverageGap> gaps) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kShared));
  VICTORIOUS_ASSIGN_OR_RETURN(
      const Result deleted, connection_->Query("DELETE FROM video_cuts WHERE video_id = ? AND plan = ?", video, plan));
  if (deleted.Changes() == 0) return transaction.Commit();
  for (const std::int64_t model : models) {
    VICTORIOUS_RETURN_IF_ERROR(
        connection_->Query("DELETE FROM gaps WHERE video_id = ? AND model_id = ?", video, model));
    for (const CoverageGap& gap : gaps) {
      VICTORIOUS_RETURN_IF_ERROR(
          connection_->Query("INSERT INTO gaps (video_id, model_id, from_frame, to_frame, from_s, to_s, reason) VALUES "
                             "(?, ?, ?, ?, ?, ?, ?)",
                             video, model, gap.frames.from, gap.frames.to, gap.from_s, gap.to_s, gap.reason));
    }
  }
  return transaction.Commit();
}

Expected<std::vector<CoverageGap>> PostgresSegmentStore::Gaps() {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result rows, connection_->Query("SELECT DISTINCT video_id, from_frame, to_frame, from_s, to_s, reason FROM gaps "
                                      "ORDER BY video_id, from_frame, to_frame"));
  std::vector<CoverageGap> gaps;
  while (rows.Next()) {
    gaps.push_back({.video = rows.Integer(0),
                    .frames = {rows.Integer(1), rows.Integer(2)},
                    .from_s = rows.Real(3),
                    .to_s = rows.Real(4),
                    .reason = rows.Text(5)});
  }
  return gaps;
}

}  // namespace
}  // namespace victorious::postgres

namespace victorious {

Expected<std::unique_ptr<SegmentStore>> OpenPostgresSegmentStore(const std::string& url, StoreMode mode) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto connection, postgres::Connection::Open(url, mode == StoreMode::kRead));
  VICTORIOUS_RETURN_IF_ERROR(postgres::CheckVersion(*connection));
  return std::make_unique<postgres::PostgresSegmentStore>(std::move(connection));
}

}  // namespace victorious

#include "victorious/store/postgres/postgres_segment_store.h"

#include <array>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "victorious/base/check.h"
#include "victorious/base/enum_text.h"
#include "victorious/store/postgres/migrations.h"

namespace victorious::postgres {
namespace {

constexpr auto kSegmentStateTexts = std::to_array<EnumText<SegmentState>>(
    {{SegmentState::kOpen, "open"}, {SegmentState::kDone, "done"}, {SegmentState::kQuarantined, "quarantined"}});

// As the text of a bigint[].
std::string ArrayText(std::span<const std::int64_t> numbers) { return fmt::format("{{{}}}", fmt::join(numbers, ",")); }

class PostgresSegmentStore final : public SegmentStore {
 public:
  explicit PostgresSegmentStore(std::shared_ptr<Connection> connection) : connection_(std::move(connection)) {}

  [[nodiscard]] Expected<std::int64_t> Put(const VideoCut& cut, std::span<const std::int64_t> models,
                                           std::span<const std::byte> prepared,
                                           std::span<const std::vector<std::byte>> of_segments) override;
  [[nodiscard]] Expected<std::optional<VideoCut>> Find(std::int64_t cut) override;
  [[nodiscard]] Expected<std::vector<VideoCut>> CutsOf(std::int64_t video) override;
  [[nodiscard]] Expected<std::vector<std::byte>> Prepared(std::int64_t cut) override;
  [[nodiscard]] Expected<std::vector<std::byte>> PreparedOf(std::int64_t cut, FrameInterval frames) override;
  [[nodiscard]] Status Complete(std::int64_t cut, FrameInterval frames, std::span<const std::byte> results) override;
  [[nodiscard]] Status VisitResults(
      std::int64_t cut, const std::function<Status(FrameInterval, std::span<const std::byte>)>& visit) override;
  [[nodiscard]] Status Discard(std::int64_t cut, std::int64_t frame) override;
  [[nodiscard]] Status SetWhole(std::int64_t cut) override;
  [[nodiscard]] Status GiveUp(std::int64_t cut, FrameInterval frames, const std::string& reason) override;
  [[nodiscard]] Status Finish(std::int64_t cut, std::span<const CoverageGap> gaps) override;
  [[nodiscard]] Expected<std::vector<CoverageGap>> Gaps() override;
  [[nodiscard]] Expected<std::vector<QuarantinedSegment>> Quarantined() override;

 private:
  [[nodiscard]] std::unexpected<Error> NoSegment(std::int64_t cut, FrameInterval frames) const;
  // @param column  that has this value: "id" or "video_id"
  Expected<std::vector<VideoCut>> ReadCuts(std::string_view column, std::int64_t value);
  [[nodiscard]] std::unexpected<Error> NoCut(std::int64_t cut) const;

  std::shared_ptr<Connection> connection_;
};

std::unexpected<Error> PostgresSegmentStore::NoCut(std::int64_t cut) const {
  return Fail(ErrorCode::kNotFound,
              fmt::format("{}: cut {} of a video is not there any more", connection_->name(), cut));
}

std::unexpected<Error> PostgresSegmentStore::NoSegment(std::int64_t cut, FrameInterval frames) const {
  return Fail(ErrorCode::kNotFound, fmt::format("{}: frames {} to {} are no segment of cut {} any more",
                                                connection_->name(), frames.from, frames.to - 1, cut));
}

Expected<std::int64_t> PostgresSegmentStore::Put(const VideoCut& cut, std::span<const std::int64_t> models,
                                                 std::span<const std::byte> prepared,
                                                 std::span<const std::vector<std::byte>> of_segments) {
  VICTORIOUS_CHECK(of_segments.empty() || of_segments.size() == cut.segments.size());
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kShared));
  const std::string model_ids = ArrayText(models);
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Query("DELETE FROM video_cuts WHERE video_id = ? AND plan <> ? AND models && ?::text::bigint[]",
                         cut.video, cut.plan, model_ids));
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result added,
      connection_->Query("INSERT INTO video_cuts (video_id, models, plan, step, is_whole, prepared) VALUES (?, "
                         "?::text::bigint[], ?, ?, ?::bigint <> 0, ?) ON CONFLICT (video_id, md5(plan)) DO NOTHING "
                         "RETURNING id",
                         cut.video, model_ids, cut.plan, cut.step, cut.is_whole ? 1 : 0, prepared));
  std::int64_t id = 0;
  if (added.Next()) {
    id = added.Integer(0);
    for (std::size_t i = 0; i < cut.segments.size(); ++i) {
      const Segment& segment = cut.segments[i];
      const std::span<const std::byte> own = of_segments.empty() ? std::span<const std::byte>() : of_segments[i];
      VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
          "INSERT INTO segments (cut_id, from_frame, to_frame, state, reason, prepared) VALUES (?, ?, ?, ?, ?, ?)", id,
          segment.frames.from, segment.frames.to, ToText(kSegmentStateTexts, segment.state), segment.reason, own));
    }
  } else {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Result present,
        connection_->Query("SELECT id FROM video_cuts WHERE video_id = ? AND plan = ?", cut.video, cut.plan));
    if (!present.Next()) return NoCut(cut.id);
    id = present.Integer(0);
  }
  VICTORIOUS_RETURN_IF_ERROR(transaction.Commit());
  return id;
}

// One statement, so that a cut and its segments are of one state of the index.
Expected<std::vector<VideoCut>> PostgresSegmentStore::ReadCuts(std::string_view column, std::int64_t value) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result rows,
      connection_->Query(fmt::format("SELECT c.id, c.video_id, c.plan, c.step, c.is_whole, s.from_frame, s.to_frame, "
                                     "s.state, s.reason FROM video_cuts c LEFT JOIN segments s ON s.cut_id = c.id "
                                     "WHERE c.{} = ? ORDER BY c.id, s.from_frame",
                                     column),
                         value));
  std::vector<VideoCut> cuts;
  while (rows.Next()) {
    if (cuts.empty() || cuts.back().id != rows.Integer(0)) {
      cuts.push_back({.id = rows.Integer(0),
                      .video = rows.Integer(1),
                      .plan = rows.Text(2),
                      .step = rows.Integer(3),
                      .is_whole = rows.Integer(4) != 0});
    }
    const std::optional<std::int64_t> from = rows.OptionalInteger(5);
    if (!from) continue;
    const std::optional<SegmentState> state = FromText(kSegmentStateTexts, rows.Text(7));
    if (!state) return std::unexpected(sql::DamagedIndex(connection_->name(), "a segment of an unknown state"));
    cuts.back().segments.push_back({{*from, rows.Integer(6)}, *state, rows.Text(8)});
  }
  return cuts;
}

Expected<std::optional<VideoCut>> PostgresSegmentStore::Find(std::int64_t cut) {
  VICTORIOUS_ASSIGN_OR_RETURN(std::vector<VideoCut> found, ReadCuts("id", cut));
  return found.empty() ? std::nullopt : std::optional(std::move(found.front()));
}

Expected<std::vector<VideoCut>> PostgresSegmentStore::CutsOf(std::int64_t video) { return ReadCuts("video_id", video); }

Expected<std::vector<std::byte>> PostgresSegmentStore::Prepared(std::int64_t cut) {
  VICTORIOUS_ASSIGN_OR_RETURN(Result row, connection_->Query("SELECT prepared FROM video_cuts WHERE id = ?", cut));
  if (!row.Next()) return NoCut(cut);
  const std::span<const std::byte> bytes = row.Blob(0);
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

Expected<std::vector<std::byte>> PostgresSegmentStore::PreparedOf(std::int64_t cut, FrameInterval frames) {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result row, connection_->Query("SELECT prepared FROM segments WHERE cut_id = ? AND from_frame = ? AND "
                                     "to_frame = ? AND state = 'open' AND prepared IS NOT NULL",
                                     cut, frames.from, frames.to));
  if (!row.Next()) return NoSegment(cut, frames);
  const std::span<const std::byte> bytes = row.Blob(0);
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

Status PostgresSegmentStore::Complete(std::int64_t cut, FrameInterval frames, std::span<const std::byte> results) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kShared));
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result found,
      connection_->Query("SELECT state FROM segments WHERE cut_id = ? AND from_frame = ? AND to_frame = ? FOR UPDATE",
                         cut, frames.from, frames.to));
  if (!found.Next()) return NoSegment(cut, frames);
  // One that was given up meanwhile stays a gap.
  if (found.Text(0) == ToText(kSegmentStateTexts, SegmentState::kOpen)) {
    VICTORIOUS_RETURN_IF_ERROR(
        connection_->Query("UPDATE segments SET state = 'done', reason = '', results = ?, prepared = NULL WHERE cut_id "
                           "= ? AND from_frame = ?",
                           results, cut, frames.from));
  }
  return transaction.Commit();
}

Status PostgresSegmentStore::VisitResults(
    std::int64_t cut, const std::function<Status(FrameInterval, std::span<const std::byte>)>& visit) {
  std::int64_t next_frame = 0;
  // One statement a segment, not a cursor: the visit writes, through another connection, for minutes.
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Result row,
        connection_->Query("SELECT from_frame, to_frame, results FROM segments WHERE cut_id = ? AND state "
                           "= 'done' AND results IS NOT NULL AND from_frame >= ? ORDER BY from_frame LIMIT 1",
                           cut, next_frame));
    if (!row.Next()) break;
    next_frame = row.Integer(1);
    VICTORIOUS_RETURN_IF_ERROR(visit({row.Integer(0), row.Integer(1)}, row.Blob(2)));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<VideoCut> present, Find(cut));
  return present ? Status() : NoCut(cut);
}

Status PostgresSegmentStore::Discard(std::int64_t cut, std::int64_t frame) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kShared));
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Query("UPDATE segments SET results = NULL WHERE cut_id = ? AND to_frame <= ? AND state = 'done' AND "
                         "results IS NOT NULL",
                         cut, frame));
  return transaction.Commit();
}

Status PostgresSegmentStore::SetWhole(std::int64_t cut) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kAll));
  for (const std::string_view table : {"tracklets", "searches"}) {
    VICTORIOUS_RETURN_IF_ERROR(
        connection_->Query(fmt::format("DELETE FROM {} t USING video_cuts c WHERE c.id = ? AND t.video_id = c.video_id "
                                       "AND t.model_id = ANY (c.models)",
                                       table),
                           cut));
  }
  VICTORIOUS_RETURN_IF_ERROR(connection_->Query("UPDATE video_cuts SET is_whole = true WHERE id = ?", cut));
  return transaction.Commit();
}

Status PostgresSegmentStore::GiveUp(std::int64_t cut, FrameInterval frames, const std::string& reason) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kShared));
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result found,
      connection_->Query("SELECT c.step FROM segments s JOIN video_cuts c ON c.id = s.cut_id WHERE s.cut_id = ? AND "
                         "s.from_frame = ? AND s.to_frame = ? AND s.state = 'open' FOR UPDATE",
                         cut, frames.from, frames.to));
  if (!found.Next()) return transaction.Commit();
  const std::optional<std::int64_t> middle = MiddleOf(frames, found.Integer(0));
  if (middle) {
    VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
        "INSERT INTO segments (cut_id, from_frame, to_frame, prepared) SELECT cut_id, ?, to_frame, prepared FROM "
        "segments WHERE cut_id = ? AND from_frame = ?",
        *middle, cut, frames.from));
    VICTORIOUS_RETURN_IF_ERROR(connection_->Query(
        "UPDATE segments SET to_frame = ? WHERE cut_id = ? AND from_frame = ?", *middle, cut, frames.from));
  } else {
    VICTORIOUS_RETURN_IF_ERROR(
        connection_->Query("UPDATE segments SET state = 'quarantined', reason = ? WHERE cut_id = ? AND from_frame = ?",
                           reason, cut, frames.from));
  }
  return transaction.Commit();
}

Status PostgresSegmentStore::Finish(std::int64_t cut, std::span<const CoverageGap> gaps) {
  VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_, Exclusion::kShared));
  VICTORIOUS_RETURN_IF_ERROR(
      connection_->Query("DELETE FROM gaps g USING video_cuts c WHERE c.id = ? AND g.video_id = c.video_id AND "
                         "g.model_id = ANY (c.models)",
                         cut));
  for (const CoverageGap& gap : gaps) {
    VICTORIOUS_RETURN_IF_ERROR(
        connection_->Query("INSERT INTO gaps (video_id, model_id, from_frame, to_frame, from_s, to_s, reason) SELECT "
                           "video_id, unnest(models), ?, ?, ?, ?, ? FROM video_cuts WHERE id = ?",
                           gap.frames.from, gap.frames.to, gap.from_s, gap.to_s, gap.reason, cut));
  }
  VICTORIOUS_RETURN_IF_ERROR(connection_->Query("DELETE FROM video_cuts WHERE id = ?", cut));
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

Expected<std::vector<QuarantinedSegment>> PostgresSegmentStore::Quarantined() {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result rows, connection_->Query("SELECT DISTINCT c.video_id, s.from_frame, s.to_frame, s.reason FROM segments s "
                                      "JOIN video_cuts c ON c.id = s.cut_id WHERE s.state = 'quarantined' "
                                      "ORDER BY c.video_id, s.from_frame, s.to_frame"));
  std::vector<QuarantinedSegment> segments;
  while (rows.Next()) {
    segments.push_back(
        {.video = rows.Integer(0), .frames = {rows.Integer(1), rows.Integer(2)}, .reason = rows.Text(3)});
  }
  return segments;
}

}  // namespace
}  // namespace victorious::postgres

namespace victorious {

Expected<std::unique_ptr<SegmentStore>> OpenPostgresSegmentStore(const std::string& url, StoreMode mode,
                                                                 std::optional<TaskAttempt> task) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto connection, postgres::Connection::Open(url, mode == StoreMode::kRead, {}, task));
  VICTORIOUS_RETURN_IF_ERROR(postgres::CheckVersion(*connection));
  return MakePostgresSegmentStore(std::move(connection));
}

std::unique_ptr<SegmentStore> MakePostgresSegmentStore(std::shared_ptr<postgres::Connection> connection) {
  return std::make_unique<postgres::PostgresSegmentStore>(std::move(connection));
}

}  // namespace victorious

#include "victorious/apps/serve/threshold_routes.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/serve/api_json.h"
#include "victorious/apps/serve/api_response.h"
#include "victorious/apps/serve/request_target.h"
#include "victorious/base/json.h"
#include "victorious/base/utc.h"

namespace victorious {
namespace {

constexpr std::size_t kMaxLists = 2;  // the present one, and one that others wait for

// The objects of a model without a verdict that score less than a threshold.
Expected<std::int64_t> CountUndecidedBelow(TriageStore& store, const std::string& model, double min_score) {
  ObjectQuery undecided{.models = {model}, .review = ObjectQuery::ReviewState::kNone};
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t all, store.CountObjects(undecided));
  undecided.min_score = min_score;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t above, store.CountObjects(undecided));
  return all - above;
}

// The body {"min_score": number or null, "reviewer": text}.
struct ThresholdInput {
  std::optional<double> min_score;
  std::string reviewer;
};

ApiExpected<ThresholdInput> ParseThreshold(std::string_view body) {
  constexpr std::size_t kMaxNameBytes = 100;
  const auto json = ParseJson(body);
  if (!json) return std::unexpected(ApiError(json.error()));
  if (!json->is_object() || !json->contains("min_score")) {
    return FailField("min_score", "the body must be {\"min_score\": number or null}");
  }
  ThresholdInput input;
  for (const auto& [key, value] : json->items()) {
    if (key == "min_score") {
      if (value.is_null()) continue;
      if (!value.is_number() || !(value.get<double>() >= 0 && value.get<double>() <= 1)) {
        return FailField("min_score", "The threshold must be a number from 0 to 1, or null");
      }
      input.min_score = value.get<double>();
    } else if (key == "reviewer") {
      if (!value.is_string() || value.get<std::string>().size() > kMaxNameBytes) {
        return FailField("reviewer", fmt::format("The reviewer must be a text of at most {} bytes", kMaxNameBytes));
      }
      input.reviewer = value.get<std::string>();
    } else {
      return FailField(key, "Only min_score and reviewer can be set");
    }
  }
  return input;
}

}  // namespace

ThresholdRoutes::ThresholdRoutes(IndexView& index, std::unique_ptr<ThresholdStore> thresholds)
    : index_(index), thresholds_(std::move(thresholds)), lists_(kMaxLists) {}

Expected<std::string> ThresholdRoutes::MakeList(const IndexLists& lists) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto reader, index_.Borrow());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelThreshold> in_force, reader->thresholds->Thresholds());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ModelDecisions> decided, reader->thresholds->Decisions());
  Json rows = Json::array();
  for (const ModelRecord& model : lists.models) {
    const auto decisions = std::ranges::find(decided, model.id, &ModelDecisions::model);
    const auto threshold = std::ranges::find(in_force, model.name, &ModelThreshold::model);
    const bool is_decided = decisions != decided.end();
    if (!is_decided && threshold == in_force.end()) continue;
    const std::span<const DecidedScore> scores =
        is_decided ? std::span<const DecidedScore>(decisions->decisions) : std::span<const DecidedScore>();
    const auto accepted = std::ranges::count(scores, true, &DecidedScore::is_accepted);
    Json learnt;
    if (const auto found = LearnThreshold(scores)) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t below,
                                  CountUndecidedBelow(*reader->objects, model.name, found->min_score));
      learnt = {{"min_score", ScoreJson(found->min_score)},
                {"accepted_below", found->accepted_below},
                {"rejected_below", found->rejected_below},
                {"undecided_below", below}};
    }
    Json applied;
    if (threshold != in_force.end()) {
      VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t below,
                                  CountUndecidedBelow(*reader->objects, model.name, threshold->min_score));
      applied = {{"min_score", ScoreJson(threshold->min_score)},
                 {"set_by", threshold->set_by},
                 {"set_utc_us", threshold->set_utc_us},
                 {"undecided_below", below}};
    }
    rows.push_back({{"model_id", model.id},
                    {"model", model.name},
                    {"is_category", model.IsCategory() && !model.IsBoxed()},
                    {"accepted", accepted},
                    {"rejected", std::ssize(scores) - accepted},
                    {"learnt", std::move(learnt)},
                    {"in_force", std::move(applied)}});
  }
  return DumpJson(Json{{"min_decisions", kMinDecisions}, {"models", std::move(rows)}}) + "\n";
}

Expected<std::shared_ptr<const std::string>> ThresholdRoutes::CurrentList() {
  // Both are read before what is counted: a change in between makes another key.
  const std::int64_t own_changes = index_.own_changes();
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_.Lists());
  return lists_.Get(fmt::format("{} {}", lists->version, own_changes), [&] { return MakeList(*lists); });
}

ApiExpected<HttpResponse> ThresholdRoutes::List(const ApiCall& /*call*/) {
  VICTORIOUS_ASSIGN_OR_RETURN(const auto body, CurrentList());
  return JsonTextResponse(*body);
}

ApiExpected<HttpResponse> ThresholdRoutes::Put(const ApiCall& call) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t id, ParseId(call.parameters[0], "model"));
  VICTORIOUS_ASSIGN_OR_RETURN(const auto lists, index_.Lists());
  const ModelRecord* model = lists->Model(id);
  if (model == nullptr) return NotFound(fmt::format("model {} is not in the index", id));
  VICTORIOUS_ASSIGN_OR_RETURN(ThresholdInput input, ParseThreshold(call.request.body));
  if (!index_.can_review()) {
    return std::unexpected(ApiError(Error{
        ErrorCode::kPermissionDenied,
        "the index cannot be written, so thresholds are not kept: allow writing to the file and its folder, then start "
        "`victorious serve` again"}));
  }
  // With accounts, nobody decides in the name of another.
  const std::string actor = call.caller.is_open ? std::move(input.reviewer) : call.caller.name();
  {
    const std::scoped_lock lock(mutex_);
    const std::int64_t now_us = NowUtcMicroseconds();
    VICTORIOUS_RETURN_IF_ERROR(
        input.min_score
            ? thresholds_->Put(
                  {.model = model->name, .min_score = *input.min_score, .set_by = actor, .set_utc_us = now_us})
            : thresholds_->Remove(model->name, actor, now_us));
  }
  index_.NoteOwnChange();
  return List(call);
}

}  // namespace victorious

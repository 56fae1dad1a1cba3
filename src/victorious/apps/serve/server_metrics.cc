#include "victorious/apps/serve/server_metrics.h"

#include <fmt/format.h>

namespace victorious {
namespace {

std::string_view NameOf(HttpMethod method) {
  switch (method) {
    case HttpMethod::kGet:
      return "GET";
    case HttpMethod::kHead:
      return "HEAD";
    case HttpMethod::kPut:
      return "PUT";
    case HttpMethod::kPost:
      return "POST";
    case HttpMethod::kDelete:
      return "DELETE";
    case HttpMethod::kOther:
      break;
  }
  return "other";
}

std::string_view NameOf(ServerMetrics::Group group) {
  switch (group) {
    case ServerMetrics::Group::kQuick:
      return "quick";
    case ServerMetrics::Group::kSlow:
      return "slow";
    case ServerMetrics::Group::kPageFile:
      return "page";
    case ServerMetrics::Group::kRefused:
      break;
  }
  return "refused";
}

std::string Heading(std::string_view name, std::string_view type, std::string_view help) {
  return fmt::format("# HELP {0} {2}\n# TYPE {0} {1}\n", name, type, help);
}

}  // namespace

std::string MetricLabel(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '\n') {
      quoted += "\\n";
      continue;
    }
    if (c == '\\' || c == '"') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

void ServerMetrics::Count(Group group, HttpMethod method, std::string_view route, int status,
                          std::chrono::nanoseconds took) {
  const double took_s = std::chrono::duration<double>(took).count();
  const std::scoped_lock lock(mutex_);
  ++requests_[{std::string(route), method, status}];
  Histogram& histogram = durations_[group];
  for (std::size_t i = 0; i < kBounds_s.size(); ++i) histogram.at_most[i] += took_s <= kBounds_s[i] ? 1 : 0;
  ++histogram.count;
  histogram.sum_s += took_s;
}

ServerMetrics::Decoding::Decoding(std::shared_ptr<ServerMetrics> metrics) : metrics_(std::move(metrics)) {
  const std::scoped_lock lock(metrics_->mutex_);
  ++metrics_->waiting_;
}

ServerMetrics::Decoding::~Decoding() {
  const std::scoped_lock lock(metrics_->mutex_);
  --(is_running_ ? metrics_->running_ : metrics_->waiting_);
}

void ServerMetrics::Decoding::Start() {
  const std::scoped_lock lock(metrics_->mutex_);
  if (is_running_) return;
  is_running_ = true;
  --metrics_->waiting_;
  ++metrics_->running_;
}

std::string ServerMetrics::Text(const std::vector<MetricSample>& samples) const {
  std::string text;
  {
    const std::scoped_lock lock(mutex_);
    text +=
        Heading("victorious_http_requests_total", "counter", "Answered requests; a status of 500 or more is an error");
    for (const auto& [key, count] : requests_) {
      const auto& [route, method, status] = key;
      text += fmt::format("victorious_http_requests_total{{route={},method=\"{}\",status=\"{}\"}} {}\n",
                          MetricLabel(route), NameOf(method), status, count);
    }
    constexpr std::string_view kDuration = "victorious_http_request_duration_seconds";
    text += Heading(kDuration, "histogram", "From the admission of a request to its answer");
    for (const auto& [group, histogram] : durations_) {
      for (std::size_t i = 0; i < kBounds_s.size(); ++i) {
        text += fmt::format("{}_bucket{{group=\"{}\",le=\"{}\"}} {}\n", kDuration, NameOf(group), kBounds_s[i],
                            histogram.at_most[i]);
      }
      text += fmt::format(
          "{0}_bucket{{group=\"{1}\",le=\"+Inf\"}} {2}\n{0}_sum{{group=\"{1}\"}} {3}\n"
          "{0}_count{{group=\"{1}\"}} {2}\n",
          kDuration, NameOf(group), histogram.count, histogram.sum_s);
    }
    text += Heading("victorious_decodings", "gauge", "Answers that read a video");
    text += fmt::format("victorious_decodings{{state=\"waiting\"}} {}\nvictorious_decodings{{state=\"running\"}} {}\n",
                        waiting_, running_);
  }
  std::string_view last;
  for (const MetricSample& sample : samples) {
    if (sample.name != last) text += Heading(sample.name, "gauge", sample.help);
    last = sample.name;
    text += fmt::format("{}{} {}\n", sample.name, sample.labels, sample.value);
  }
  return text;
}

}  // namespace victorious

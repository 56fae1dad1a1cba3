#include "experiments/report.h"

#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/file.h"
#include "victorious/base/json.h"
#include "victorious/lab/evaluate/score.h"

namespace victorious {
namespace {

using nlohmann::ordered_json;

template <typename... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};
template <typename... Visitors>
Overloaded(Visitors...) -> Overloaded<Visitors...>;

ordered_json ReportToJson(const Report& report) {
  ordered_json rows = ordered_json::array();
  for (const auto& row : report.rows) {
    ordered_json one = ordered_json::object();
    for (std::size_t i = 0; i < row.size(); ++i) {
      one[report.columns[i]] =
          std::visit(Overloaded{[](const std::string& text) { return ordered_json(text); },
                                [](double number) { return ordered_json(number); },
                                [](const MeanWithError& m) {
                                  return ordered_json{{"mean", m.mean}, {"standard_error", m.standard_error}};
                                }},
                     row[i]);
    }
    rows.push_back(std::move(one));
  }
  return {{"experiment", report.name}, {"title", report.title}, {"notes", report.notes}, {"rows", std::move(rows)}};
}

std::string Quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

bool HasErrors(const Report& report, std::size_t column) {
  for (const auto& row : report.rows)
    if (std::holds_alternative<MeanWithError>(row[column])) return true;
  return false;
}

std::string ReportToCsv(const Report& report) {
  std::string csv;
  for (std::size_t i = 0; i < report.columns.size(); ++i) {
    csv += (i > 0 ? "," : "") + Quoted(report.columns[i]);
    if (HasErrors(report, i)) csv += "," + Quoted(report.columns[i] + " standard error");
  }
  csv += "\n";
  for (const auto& row : report.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i > 0) csv += ",";
      const bool has_errors = HasErrors(report, i);
      csv += std::visit(
          Overloaded{[&](const std::string& text) { return Quoted(text) + (has_errors ? "," : ""); },
                     [&](double number) { return fmt::format("{:.6g}{}", number, has_errors ? "," : ""); },
                     [](const MeanWithError& m) { return fmt::format("{:.6g},{:.6g}", m.mean, m.standard_error); }},
          row[i]);
    }
    csv += "\n";
  }
  return csv;
}

}  // namespace

MeanWithError ComputeMean(const std::vector<double>& values) {
  if (values.empty()) return {};
  const auto count = static_cast<double>(values.size());
  double mean = 0;
  for (const double value : values) mean += value / count;
  if (values.size() == 1) return {.mean = mean, .standard_error = 0};
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {.mean = mean, .standard_error = std::sqrt(squares / (count - 1) / count)};
}

Cell FormatPercentile(const std::vector<double>& values, double percent) {
  const std::optional<double> value = Percentile(values, percent);
  return value ? Cell(*value) : Cell("-");
}

Status WriteReport(const Report& report, const std::filesystem::path& folder) {
  VICTORIOUS_RETURN_IF_ERROR(
      WriteFileAtomically(folder / (report.name + ".json"), DumpJson(ReportToJson(report), 2) + "\n"));
  VICTORIOUS_RETURN_IF_ERROR(WriteFileAtomically(folder / (report.name + ".csv"), ReportToCsv(report)));
  if (report.plot.lines.empty()) return {};
  return WriteFileAtomically(folder / (report.name + ".svg"), RenderSvg(report.plot));
}

std::string ToMarkdown(const Report& report) {
  std::string text = report.title + "\n\n|";
  for (const std::string& column : report.columns) text += " " + column + " |";
  text += "\n|";
  for (std::size_t i = 0; i < report.columns.size(); ++i) text += " --- |";
  text += "\n";
  for (const auto& row : report.rows) {
    text += "|";
    for (const Cell& cell : row) {
      text += " " +
              std::visit(Overloaded{[](const std::string& words) { return words; },
                                    [](double number) { return fmt::format("{:.4g}", number); },
                                    [](const MeanWithError& m) {
                                      return fmt::format("{:.4g} ± {:.2g}", m.mean, m.standard_error);
                                    }},
                         cell) +
              " |";
    }
    text += "\n";
  }
  for (const std::string& note : report.notes) text += "\n" + note + "\n";
  return text;
}

}  // namespace victorious

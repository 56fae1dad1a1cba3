#include "victorious/place/associate/flight_evidence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>

namespace victorious {
namespace {

// Before a flight is seen. Chosen: of ten flights one has telemetry of another clock or of another flight, of fifty
// models one is in the wrong unit.
constexpr double kWrongTelemetry = 0.1;
constexpr double kWrongLength = 0.02;

// However strong its recognition, one object alone decides nothing.
constexpr double kMaxProbability = 0.99;

// The probability of each finding. Chosen: false detections lie anywhere, a real object with telemetry and length right
// is contradicted if it moves as no model of motion describes (no intersection), or if it flies (above).
struct Probabilities {
  double false_find;
  double real;             // telemetry and length are right
  double wrong_telemetry;  // of a real object, whatever its length
  double wrong_length;     // of a real object, telemetry right
};

Probabilities ProbabilitiesOf(PlaceFinding finding) {
  switch (finding) {
    case PlaceFinding::kNothing:
      return {1, 1, 1, 1};
    case PlaceFinding::kAgrees:
      return {0.2, 0.9, 0.05, 0.02};
    case PlaceFinding::kImpossible:
      return {0.5, 0.005, 0.6, 0.8};
    case PlaceFinding::kAbove:
      return {0.1, 0.03, 0.1, 0.1};
    case PlaceFinding::kNoIntersection:
      return {0.2, 0.05, 0.3, 0.08};
  }
  return {1, 1, 1, 1};
}

// By [telemetry is wrong][length is wrong].
using Table = std::array<std::array<double, 2>, 2>;

double OfReal(const Probabilities& of, std::size_t telemetry, std::size_t length) {
  if (telemetry == 1) return of.wrong_telemetry;
  return length == 1 ? of.wrong_length : of.real;
}

// ln f_i(T, M)
Table LogLikelihood(const FindingOfObject& object) {
  const Probabilities of = ProbabilitiesOf(object.finding);
  const double real = std::clamp(object.probability, 0.0, kMaxProbability);
  Table result;
  for (std::size_t telemetry = 0; telemetry < 2; ++telemetry) {
    for (std::size_t length = 0; length < 2; ++length)
      result[telemetry][length] = std::log(real * OfReal(of, telemetry, length) + (1 - real) * of.false_find);
  }
  return result;
}

double LogSumExp(double a, double b) {
  const double larger = std::max(a, b);
  return larger + std::log(std::exp(a - larger) + std::exp(b - larger));
}

double LogPrior(double wrong, std::size_t is_wrong) { return std::log(is_wrong == 1 ? wrong : 1 - wrong); }

}  // namespace

std::vector<double> WeighFindings(std::span<const FindingOfObject> objects) {
  std::vector<Table> of_objects;
  of_objects.reserve(objects.size());
  std::map<std::int64_t, Table> of_models;  // ln P(M) prod f_i(T, M)
  for (const FindingOfObject& object : objects) {
    of_objects.push_back(LogLikelihood(object));
    const auto [found, is_new] = of_models.try_emplace(object.model);
    Table& sum = found->second;
    for (std::size_t telemetry = 0; telemetry < 2; ++telemetry) {
      for (std::size_t length = 0; length < 2; ++length) {
        if (is_new) sum[telemetry][length] = LogPrior(kWrongLength, length);
        sum[telemetry][length] += of_objects.back()[telemetry][length];
      }
    }
  }
  std::array<double, 2> all = {LogPrior(kWrongTelemetry, 0), LogPrior(kWrongTelemetry, 1)};  // by T
  for (const auto& [model, sum] : of_models) {
    for (std::size_t telemetry = 0; telemetry < 2; ++telemetry)
      all[telemetry] += LogSumExp(sum[telemetry][0], sum[telemetry][1]);
  }
  std::vector<double> weights(objects.size(), 0.0);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i].finding == PlaceFinding::kNothing) continue;
    const Probabilities of = ProbabilitiesOf(objects[i].finding);
    const Table& sum = of_models.at(objects[i].model);
    Table others;  // ln P(T, M) without this object
    double largest = -INFINITY;
    for (std::size_t telemetry = 0; telemetry < 2; ++telemetry) {
      const double of_other_models = all[telemetry] - LogSumExp(sum[telemetry][0], sum[telemetry][1]);
      for (std::size_t length = 0; length < 2; ++length) {
        others[telemetry][length] = of_other_models + sum[telemetry][length] - of_objects[i][telemetry][length];
        largest = std::max(largest, others[telemetry][length]);
      }
    }
    double total = 0;
    double of_real = 0;
    for (std::size_t telemetry = 0; telemetry < 2; ++telemetry) {
      for (std::size_t length = 0; length < 2; ++length) {
        const double probability = std::exp(others[telemetry][length] - largest);
        total += probability;
        of_real += probability * OfReal(of, telemetry, length);
      }
    }
    weights[i] = std::log(of_real / total / of.false_find);
  }
  return weights;
}

}  // namespace victorious

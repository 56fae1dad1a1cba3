#include "victorious/category/category_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/base/sealed_bytes.h"

namespace victorious {
namespace {

constexpr FileMagic kMagic = {0x8A, 'V', 'C', 'A', 'T', 0x0D, 0x0A, 0x1A};
constexpr std::uint32_t kFileVersion = 4;  // the only one that is read

class Writer {
 public:
  template <typename T>
    requires std::is_trivially_copyable_v<T>
  void Put(const T& value) {
    Append(std::as_bytes(std::span(&value, 1)));
  }
  /// Writes the number of values, then the values.
  template <typename T>
  void PutAll(std::span<const T> values) {
    Put(static_cast<std::uint64_t>(values.size()));
    Append(std::as_bytes(values));
  }
  void PutText(const std::string& text) { PutAll(std::span<const char>(text)); }
  void PutVector(const Eigen::VectorXf& vector) {
    PutAll(std::span<const float>(vector.data(), static_cast<std::size_t>(vector.size())));
  }
  [[nodiscard]] const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  void Append(std::span<const std::byte> more) { bytes_.insert(bytes_.end(), more.begin(), more.end()); }

  std::vector<std::byte> bytes_;
};

// Reads values in sequence. After the first read beyond the end or failed requirement, ok() is false and every read
// returns an empty value.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <typename T>
    requires std::is_trivially_copyable_v<T>
  T Get() {
    T value{};
    const auto bytes = Take(sizeof(T), 1);
    if (!bytes.empty()) std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }
  template <typename T>
  std::vector<T> GetAll() {
    const auto count = Get<std::uint64_t>();
    const auto bytes = Take(sizeof(T), count);
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
  std::string GetText() {
    const auto letters = GetAll<char>();
    return {letters.begin(), letters.end()};
  }
  std::vector<float> GetFloats() {
    std::vector<float> values = GetAll<float>();
    Require(std::ranges::all_of(values, [](float value) { return std::isfinite(value); }));
    return values;
  }
  Eigen::VectorXf GetVector(std::size_t size) {
    const std::vector<float> values = GetFloats();
    Require(values.size() == size);
    return Eigen::Map<const Eigen::VectorXf>(values.data(), static_cast<Eigen::Index>(values.size()));
  }
  bool Require(bool condition) {
    ok_ = ok_ && condition;
    return ok_;
  }
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }

 private:
  std::span<const std::byte> Take(std::size_t size, std::uint64_t count) {
    if (!Require(count <= rest_.size() / size)) return {};
    const auto taken = rest_.first(size * static_cast<std::size_t>(count));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }

  std::span<const std::byte> rest_;
  bool ok_ = true;
};

void PutCalibration(const Calibration& calibration, Writer& out) {
  out.Put(calibration.slope);
  out.Put(calibration.offset);
}

Calibration GetCalibration(Reader& in) {
  Calibration calibration;
  calibration.slope = in.Get<double>();
  calibration.offset = in.Get<double>();
  in.Require(std::isfinite(calibration.slope) && calibration.slope > 0 && std::isfinite(calibration.offset));
  return calibration;
}

void PutWeights(const LinearWeights& weights, Writer& out) {
  out.PutVector(weights.words);
  out.PutVector(weights.phrases);
  out.PutVector(weights.fisher);
  if (weights.shapes.size() > 0) out.PutVector(weights.shapes);
  out.Put(weights.offset);
}

LinearWeights GetWeights(std::size_t words, std::size_t phrases, std::size_t fisher, std::size_t shapes, Reader& in) {
  LinearWeights weights;
  weights.words = in.GetVector(words);
  weights.phrases = in.GetVector(phrases);
  weights.fisher = in.GetVector(fisher);
  if (shapes > 0) weights.shapes = in.GetVector(shapes);
  weights.offset = in.Get<float>();
  in.Require(std::isfinite(weights.offset));
  return weights;
}

void PutEncoder(const FisherEncoder& encoder, Writer& out) {
  out.Put(static_cast<std::uint8_t>(encoder.append_position));
  out.PutVector(encoder.mixture_weight);
  out.PutVector(encoder.mean);
  out.PutVector(encoder.projection.reshaped());
  out.PutVector(encoder.centre.reshaped());
  out.PutVector(encoder.deviation.reshaped());
}

FisherEncoder GetEncoder(Reader& in) {
  FisherEncoder encoder;
  const auto append_position = in.Get<std::uint8_t>();
  in.Require(append_position <= 1);
  encoder.append_position = append_position == 1;
  const std::vector<float> mixture_weight = in.GetFloats();
  in.Require(std::ranges::all_of(mixture_weight, [](float value) { return value > 0; }));
  const auto components = static_cast<Eigen::Index>(mixture_weight.size());
  encoder.mixture_weight = Eigen::Map<const Eigen::VectorXf>(mixture_weight.data(), components);
  encoder.mean = in.GetVector(components > 0 ? kDescriptorSize : 0);
  const std::vector<float> projection = in.GetFloats();
  const std::size_t dimensions = projection.size() / kDescriptorSize;
  in.Require(projection.size() % kDescriptorSize == 0 && (dimensions > 0) == (components > 0));
  const std::size_t values = components > 0 ? dimensions + (encoder.append_position ? 2 : 0) : 0;
  encoder.centre = in.GetVector(values * mixture_weight.size());
  encoder.deviation = in.GetVector(values * mixture_weight.size());
  in.Require((encoder.deviation.array() > 0).all());
  if (!in.ok()) return {};
  const auto rows = static_cast<Eigen::Index>(values);
  encoder.projection = Eigen::Map<const Eigen::MatrixXf>(projection.data(), static_cast<Eigen::Index>(dimensions),
                                                         static_cast<Eigen::Index>(kDescriptorSize));
  encoder.centre.resize(rows, components);
  encoder.deviation.resize(rows, components);
  return encoder;
}

void PutShapes(const LinearModel& model, Writer& out) {
  out.PutVector(model.shape.mean);
  out.PutVector(model.shape.projection.reshaped());
  out.PutVector(model.shape_examples.reshaped());
}

void GetShapes(LinearModel& model, Reader& in) {
  const std::vector<float> mean = in.GetFloats();
  const std::vector<float> projection = in.GetFloats();
  const std::vector<float> examples = in.GetFloats();
  if (!in.Require(mean.size() == kRawShapeSize && !projection.empty() && projection.size() % mean.size() == 0)) return;
  const std::size_t dimensions = projection.size() / mean.size();
  if (!in.Require(!examples.empty() && examples.size() % dimensions == 0)) return;
  const auto rows = static_cast<Eigen::Index>(dimensions);
  const auto values = static_cast<Eigen::Index>(mean.size());
  model.shape.mean = Eigen::Map<const Eigen::VectorXf>(mean.data(), values);
  model.shape.projection = Eigen::Map<const Eigen::MatrixXf>(projection.data(), rows, values);
  model.shape_examples =
      Eigen::Map<const Eigen::MatrixXf>(examples.data(), rows, static_cast<Eigen::Index>(examples.size() / dimensions));
}

void PutGrammar(const PhraseGrammar& grammar, Writer& out) {
  out.PutAll(grammar.words());
  out.PutAll(grammar.likelihoods());
  out.PutAll(grammar.samples());
}

PhraseGrammar GetGrammar(std::size_t vocabulary, const GrammarOptions& options, Reader& in) {
  constexpr std::size_t kMaxWords = 0xFFFE;
  auto words = in.GetAll<std::uint32_t>();
  auto likelihoods = in.GetFloats();
  auto samples = in.GetAll<PhraseSample>();
  in.Require(words.size() == likelihoods.size() && words.size() <= kMaxWords);
  in.Require(std::ranges::all_of(words, [&](std::uint32_t word) { return word < vocabulary; }));
  in.Require(std::ranges::all_of(likelihoods, [](float value) { return value >= 0; }));
  in.Require(std::ranges::all_of(samples, [&](const PhraseSample& sample) {
    return sample.first < words.size() && sample.second < words.size() &&
           std::ranges::all_of(sample.cells, [](std::uint8_t cell) { return cell < kMeasureCells; });
  }));
  if (!in.ok()) return {};
  return {std::move(words), std::move(likelihoods), std::move(samples), options};
}

void PutNodes(const std::vector<CategoryNode>& nodes, Writer& out) {
  out.Put(static_cast<std::uint64_t>(nodes.size()));
  for (const CategoryNode& node : nodes) {
    out.PutText(node.name);
    out.Put(static_cast<std::uint8_t>(node.can_be_label));
    PutCalibration(node.phrases, out);
    PutCalibration(node.words, out);
  }
}

std::vector<CategoryNode> GetNodes(Reader& in) {
  std::vector<CategoryNode> nodes;
  const auto count = in.Get<std::uint64_t>();
  for (std::uint64_t i = 0; i < count && in.ok(); ++i) {
    CategoryNode node{.name = in.GetText()};
    const auto can_be_label = in.Get<std::uint8_t>();
    in.Require(can_be_label <= 1 && !node.name.empty());
    node.can_be_label = can_be_label == 1;
    node.phrases = GetCalibration(in);
    node.words = GetCalibration(in);
    in.Require(nodes.empty() || nodes.back().name < node.name);
    nodes.push_back(std::move(node));
  }
  in.Require(std::ranges::any_of(nodes, &CategoryNode::can_be_label));
  return nodes;
}

Expected<CategoryOptions> ParseOptions(const std::string& text) {
  CategoryOptions options;
  if (const Status status = SetFromJsonText(text, CollectFields(options)); !status)
    return Fail(ErrorCode::kDataLoss, fmt::format("damaged (options: {})", status.error().message));
  return options;
}

void PutWindows(const std::optional<WindowTraining>& windows, Writer& out) {
  out.Put(static_cast<std::uint8_t>(windows.has_value()));
  if (!windows) return;
  out.PutText(windows->background_category);
  out.Put(windows->windows_per_background);
}

std::optional<WindowTraining> GetWindows(Reader& in) {
  const auto has_windows = in.Get<std::uint8_t>();
  in.Require(has_windows <= 1);
  if (has_windows != 1) return std::nullopt;
  WindowTraining windows{.background_category = in.GetText(), .windows_per_background = in.Get<double>()};
  in.Require(std::isfinite(windows.windows_per_background) && windows.windows_per_background >= 0);
  return windows;
}

void PutClassifier(const LinearModel& model, Writer& out) {
  out.Put(static_cast<std::uint16_t>(model.word_clusters));
  out.PutAll(std::span<const std::uint16_t>(model.cluster_of_word));
  PutEncoder(model.fisher, out);
  if (model.shape.size() > 0) PutShapes(model, out);
  for (std::size_t n = 0; n < model.word_weights.size(); ++n) {
    PutWeights(model.word_weights[n], out);
    PutWeights(model.phrase_weights[n], out);
  }
}

void PutClassifier(const ThesisModel& model, Writer& out) {
  out.PutAll(std::span<const std::uint32_t>(model.topic_nodes));
  out.PutAll(std::span<const float>(model.topics.word_given_topic.data(),
                                    static_cast<std::size_t>(model.topics.word_given_topic.size())));
  for (const PhraseGrammar& grammar : model.grammars) PutGrammar(grammar, out);
}

LinearModel GetLinear(std::size_t words, std::size_t nodes, const LinearOptions& options, Reader& in) {
  LinearModel model;
  model.word_clusters = in.Get<std::uint16_t>();
  model.cluster_of_word = in.GetAll<std::uint16_t>();
  in.Require(model.cluster_of_word.size() == words);
  in.Require(
      std::ranges::all_of(model.cluster_of_word, [&](std::uint16_t cluster) { return cluster < model.word_clusters; }));
  model.fisher = GetEncoder(in);
  if (options.shapes.weight > 0) GetShapes(model, in);
  const auto shapes = static_cast<std::size_t>(model.shape_examples.cols());
  for (std::size_t n = 0; n < nodes && in.ok(); ++n) {
    model.word_weights.push_back(GetWeights(words, 0, 0, shapes, in));
    model.phrase_weights.push_back(
        GetWeights(words, PhraseCount(model.word_clusters), model.fisher.size(), shapes, in));
  }
  return model;
}

ThesisModel GetThesis(std::size_t words, std::size_t nodes, const ThesisOptions& options, Reader& in) {
  ThesisModel model;
  model.topic_nodes = in.GetAll<std::uint32_t>();
  in.Require(!model.topic_nodes.empty());
  in.Require(std::ranges::all_of(model.topic_nodes, [&](std::uint32_t node) { return node < nodes; }));
  const auto topics = static_cast<Eigen::Index>(model.topic_nodes.size());
  const std::vector<float> word_given_topic = in.GetFloats();
  in.Require(word_given_topic.size() == words * model.topic_nodes.size());
  in.Require(std::ranges::all_of(word_given_topic, [](float probability) { return probability >= 0; }));
  if (!in.ok()) return {};
  model.topics.word_given_topic =
      Eigen::Map<const Eigen::MatrixXf>(word_given_topic.data(), static_cast<Eigen::Index>(words), topics);
  for (Eigen::Index z = 0; z < topics && in.ok(); ++z) model.grammars.push_back(GetGrammar(words, options.grammar, in));
  return model;
}

Expected<CategoryModel> ParsePayload(std::span<const std::byte> payload) {
  Reader in(payload);
  CategoryModel model;
  model.program_version = in.GetText();
  model.features_json = in.GetText();
  const std::string options = in.GetText();
  if (!in.ok()) return Fail(ErrorCode::kDataLoss, "damaged (truncated)");
  VICTORIOUS_ASSIGN_OR_RETURN(model.options, ParseOptions(options));
  model.windows = GetWindows(in);
  model.nodes = GetNodes(in);
  auto centres = in.GetAll<std::uint8_t>();
  in.Require(!centres.empty() && centres.size() % kDescriptorSize == 0);
  if (!in.ok()) return Fail(ErrorCode::kDataLoss, "damaged (categories or words)");
  model.vocabulary = Vocabulary(std::move(centres), model.options.vocabulary.root);
  const std::size_t words = model.vocabulary.size();
  if (model.options.scoring == CategoryScoring::kLinear) {
    model.classifier = GetLinear(words, model.nodes.size(), model.options.linear, in);
  } else {
    model.classifier = GetThesis(words, model.nodes.size(), model.options.thesis, in);
  }
  if (!in.Require(in.left() == 0)) return Fail(ErrorCode::kDataLoss, "damaged (weights)");
  return model;
}

Expected<CategoryModel> Parse(std::span<const std::byte> bytes) {
  const std::optional<SealedHeader> sealed = ReadSealedHeader(bytes);
  if (!sealed || !IsCategoryModelFile(bytes)) return Fail(ErrorCode::kDataLoss, "not a category model");
  const SealedHeader& header = *sealed;
  if (header.version > kFileVersion) {
    return Fail(ErrorCode::kUnsupported,
                fmt::format("written by a newer version (format {}; this program reads {}): use that version, or train "
                            "again",
                            header.version, kFileVersion));
  }
  if (header.version > 0 && header.version < kFileVersion) {
    return Fail(ErrorCode::kUnsupported, fmt::format("written by an older version (format {}; this program reads {}): "
                                                     "train again",
                                                     header.version, kFileVersion));
  }
  const std::span<const std::byte> payload = PayloadOf(bytes);
  if (header.version == 0 || header.payload_size != payload.size())
    return Fail(ErrorCode::kDataLoss, fmt::format("cut off or damaged ({} bytes, expected {})", bytes.size(),
                                                  header.payload_size + sizeof(SealedHeader)));
  if (Checksum(payload) != header.payload_checksum) return Fail(ErrorCode::kDataLoss, "damaged (wrong checksum)");
  return ParsePayload(payload);
}

}  // namespace

bool IsCategoryModelFile(std::span<const std::byte> bytes) { return HasMagic(bytes, kMagic); }

std::vector<std::byte> EncodeCategoryModel(const CategoryModel& model) {
  Writer payload;
  payload.PutText(model.program_version);
  payload.PutText(model.features_json);
  payload.PutText(OptionsToJsonText(model.options));
  PutWindows(model.windows, payload);
  PutNodes(model.nodes, payload);
  payload.PutAll(model.vocabulary.centres());
  std::visit([&](const auto& classifier) { PutClassifier(classifier, payload); }, model.classifier);
  return Seal(kMagic, kFileVersion, payload.bytes());
}

Status WriteCategoryModel(const std::filesystem::path& path, const CategoryModel& model) {
  return WriteFileAtomically(path, EncodeCategoryModel(model));
}

Expected<CategoryModel> ReadCategoryModel(const std::filesystem::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::shared_ptr<const MappedFile> file, MappedFile::Open(path));
  return ParseCategoryModel(file->bytes(), path.string());
}

Expected<CategoryModel> ParseCategoryModel(std::span<const std::byte> bytes, const std::string& name_for_errors) {
  Expected<CategoryModel> model = Parse(bytes);
  if (model) return model;
  Error error = std::move(model).error();
  if (error.code == ErrorCode::kDataLoss) error.message += ": train again";
  return std::unexpected(std::move(error).WithContext(name_for_errors));
}

}  // namespace victorious

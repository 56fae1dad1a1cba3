#include "victorious/object/mesh/simplify_gltf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/object/mesh/load_mesh.h"

namespace victorious {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;
using nlohmann::json;

constexpr std::string_view kInstancing = "EXT_mesh_gpu_instancing";
constexpr std::size_t kMaxNodes = 100'000;

// Extensions that are read, or that change nothing of geometry and base colour.
bool IsKnown(std::string_view extension) {
  static constexpr auto kKnown =
      std::to_array<std::string_view>({"KHR_texture_transform", "KHR_mesh_quantization", "KHR_draco_mesh_compression",
                                       "KHR_lights_punctual", "KHR_xmp_json_ld", kInstancing});
  return extension.starts_with("KHR_materials_") || std::ranges::find(kKnown, extension) != kKnown.end();
}

// Extensions of textures whose images the importer does not decode.
bool IsOfImages(std::string_view extension) {
  static constexpr auto kImages = std::to_array<std::string_view>(
      {"KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds"});
  return std::ranges::find(kImages, extension) != kImages.end();
}

const json& At(const json& object, std::string_view key) {
  static const json kNothing;
  if (!object.is_object()) return kNothing;
  const auto found = object.find(key);
  return found == object.end() ? kNothing : *found;
}

// The elements of an object's list; none if it has no such list.
const json& ListAt(const json& object, std::string_view key) {
  static const json kNone = json::array();
  const json& list = At(object, key);
  return list.is_array() ? list : kNone;
}

template <std::size_t n>
std::optional<std::array<double, n>> Numbers(const json& list) {
  std::array<double, n> numbers{};
  if (!list.is_array() || list.size() != n) return std::nullopt;
  for (std::size_t i = 0; i < n; ++i) {
    if (!list[i].is_number()) return std::nullopt;
    numbers[i] = list[i].get<double>();
  }
  return numbers;
}

Matrix4d TransformOf(const json& node) {
  if (const auto matrix = Numbers<16>(At(node, "matrix"))) return Eigen::Map<const Matrix4d>(matrix->data());
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  if (const auto moved = Numbers<3>(At(node, "translation"))) transform.translate(Vector3d(moved->data()));
  if (const auto turned = Numbers<4>(At(node, "rotation")))
    transform.rotate(Eigen::Quaterniond((*turned)[3], (*turned)[0], (*turned)[1], (*turned)[2]).normalized());
  if (const auto scaled = Numbers<3>(At(node, "scale"))) transform.scale(Vector3d(scaled->data()));
  return transform.matrix();
}

bool HasDraco(const json& primitive) { return At(primitive, "extensions").contains("KHR_draco_mesh_compression"); }

class Simplifier {
 public:
  explicit Simplifier(GltfFile& file) : file_(file) {}

  Expected<std::vector<std::string>> Run() {
    VICTORIOUS_RETURN_IF_ERROR(CheckRequired());
    LeaveOutTextures();
    ChooseCoordinates();
    VICTORIOUS_RETURN_IF_ERROR(PlaceInstances());
    ShapeMeshes();
    UseFloats();
    MoveToOrigin();
    DropExtension("KHR_mesh_quantization");
    DropExtension(kInstancing);
    return std::move(warnings_);
  }

 private:
  json& root() { return file_.document(); }

  Status CheckRequired() {
    for (const json& one : ListAt(root(), "extensionsRequired")) {
      if (!one.is_string()) continue;
      const std::string name = one.get<std::string>();
      if (IsKnown(name)) continue;
      if (!IsOfImages(name))
        return Fail(ErrorCode::kUnsupported,
                    fmt::format("requires the glTF extension {}, which is not read: export it without", name));
      for (const json& texture : ListAt(root(), "textures")) {
        if (At(texture, "extensions").contains(name) && !texture.contains("source")) {
          return Fail(
              ErrorCode::kUnsupported,
              fmt::format("requires the glTF extension {}, which is not read: export it with PNG or JPEG textures",
                          name));
        }
      }
    }
    return {};
  }

  void LeaveOutTextures() {
    for (const json& texture : ListAt(root(), "textures")) {
      if (texture.contains("source")) continue;
      for (const auto& [name, content] : At(texture, "extensions").items()) {
        if (IsOfImages(name))
          warnings_.push_back(
              fmt::format("texture left out: the glTF extension {} is not read: export it as PNG or JPEG", name));
      }
    }
  }

  // KHR_texture_transform: its `texCoord` takes the place of the texture's.
  void ChooseCoordinates() {
    for (json& material : root()["materials"]) {
      if (!material.is_object()) continue;
      ChooseIn(material);
      if (const auto found = material.find("pbrMetallicRoughness"); found != material.end() && found->is_object())
        ChooseIn(*found);
      if (const auto extensions = material.find("extensions");
          extensions != material.end() && extensions->is_object()) {
        for (json& extension : *extensions) {
          if (extension.is_object()) ChooseIn(extension);
        }
      }
    }
    if (root()["materials"].is_null()) root().erase("materials");
  }

  static void ChooseIn(json& object) {
    for (json& texture : object) {
      if (!texture.is_object() || !texture.contains("index")) continue;
      const json& chosen = At(At(At(texture, "extensions"), "KHR_texture_transform"), "texCoord");
      if (chosen.is_number_unsigned()) texture["texCoord"] = chosen;
    }
  }

  // EXT_mesh_gpu_instancing: a node is drawn once for each instance, and not itself.
  Status PlaceInstances() {
    const std::size_t nodes = ListAt(root(), "nodes").size();
    for (std::size_t n = 0; n < nodes; ++n) {
      const json instancing = At(At(root()["nodes"][n], "extensions"), kInstancing);
      if (!instancing.is_object() || !root()["nodes"][n].contains("mesh")) continue;
      const json& attributes = At(instancing, "attributes");
      std::array<std::pair<const char*, std::optional<AccessorValues>>, 3> parts = {{
          {"translation", file_.ReadAccessor(At(attributes, "TRANSLATION"))},
          {"rotation", file_.ReadAccessor(At(attributes, "ROTATION"))},
          {"scale", file_.ReadAccessor(At(attributes, "SCALE"))},
      }};
      std::size_t count = 0;
      for (const auto& [key, values] : parts) count = std::max(count, values ? values->count() : 0);
      if (root()["nodes"].size() + count > kMaxNodes)
        return Fail(ErrorCode::kUnsupported, fmt::format("more than {} nodes: simplify the model", kMaxNodes));
      const json mesh = root()["nodes"][n]["mesh"];
      for (std::size_t i = 0; i < count; ++i) {
        json instance = {{"mesh", mesh}};
        for (const auto& [key, values] : parts) {
          if (!values || i >= values->count()) continue;
          const auto first = values->values.begin() + static_cast<std::ptrdiff_t>(i * values->components);
          instance[key] = std::vector<double>(first, first + static_cast<std::ptrdiff_t>(values->components));
        }
        root()["nodes"].push_back(std::move(instance));
        root()["nodes"][n]["children"].push_back(root()["nodes"].size() - 1);
      }
      root()["nodes"][n].erase("mesh");
      root()["nodes"][n]["extensions"].erase(std::string(kInstancing));
    }
    return {};
  }

  // Meshes with morph targets or a skin, as they are drawn at rest: each node gets a mesh of its own.
  void ShapeMeshes() {
    const std::size_t nodes = ListAt(root(), "nodes").size();
    if (nodes > kMaxNodes) return;
    for (std::size_t n = 0; n < nodes; ++n) {
      const json node = root()["nodes"][n];
      const json* mesh = file_.Find("meshes", At(node, "mesh"));
      if (mesh == nullptr) continue;
      const std::vector<double> weights = MorphWeights(node, *mesh);
      const std::vector<Matrix4d> joints = Joints(node);
      if (weights.empty() && joints.empty()) continue;
      json shaped = *mesh;
      shaped.erase("weights");
      for (json& primitive : shaped["primitives"]) ShapePrimitive(weights, joints, primitive);
      root()["meshes"].push_back(std::move(shaped));
      json& changed = root()["nodes"][n];
      changed.erase("weights");
      changed["mesh"] = root()["meshes"].size() - 1;
      if (!joints.empty()) MoveToRoot(n);
    }
    for (json& node : root()["nodes"]) {
      if (node.is_object()) node.erase("skin");
    }
    if (root()["nodes"].is_null()) root().erase("nodes");
    root().erase("skins");
  }

  // Those of the node, or else of the mesh. Empty if they are all 0.
  static std::vector<double> MorphWeights(const json& node, const json& mesh) {
    const json& weights = ListAt(node, "weights").empty() ? ListAt(mesh, "weights") : ListAt(node, "weights");
    std::vector<double> numbers;
    for (const json& one : weights) numbers.push_back(one.is_number() ? one.get<double>() : 0);
    return std::ranges::all_of(numbers, [](double one) { return one == 0; }) ? std::vector<double>() : numbers;
  }

  // For each joint of the node's skin the transform from the mesh to the scene. Empty without a skin.
  std::vector<Matrix4d> Joints(const json& node) {
    const json* skin = file_.Find("skins", At(node, "skin"));
    if (skin == nullptr) return {};
    const auto inverse = file_.ReadAccessor(At(*skin, "inverseBindMatrices"));
    std::vector<Matrix4d> joints;
    for (const json& joint : ListAt(*skin, "joints")) {
      Matrix4d from_mesh = Matrix4d::Identity();
      if (inverse && inverse->components == 16 && joints.size() < inverse->count())
        from_mesh = Eigen::Map<const Matrix4d>(inverse->values.data() + 16 * joints.size());
      joints.push_back(SceneFromNode(joint) * from_mesh);
    }
    return joints;
  }

  Matrix4d SceneFromNode(const json& index) {
    if (parents_.empty()) {
      const json& nodes = ListAt(root(), "nodes");
      parents_.resize(nodes.size());
      for (std::size_t n = 0; n < nodes.size(); ++n) {
        for (const json& child : ListAt(nodes[n], "children")) {
          if (child.is_number_unsigned() && child.get<std::size_t>() < parents_.size())
            parents_[child.get<std::size_t>()] = n;
        }
      }
    }
    Matrix4d transform = Matrix4d::Identity();
    std::optional<std::size_t> at;
    if (index.is_number_unsigned() && index.get<std::size_t>() < parents_.size()) at = index.get<std::size_t>();
    constexpr int kMaxDepth = 1000;  // a damaged file may have a circle
    for (int depth = 0; at && depth < kMaxDepth; ++depth, at = parents_[*at])
      transform = TransformOf(root()["nodes"][*at]) * transform;
    return transform;
  }

  void ShapePrimitive(const std::vector<double>& weights, const std::vector<Matrix4d>& joints, json& primitive) {
    if (!primitive.is_object() || HasDraco(primitive)) return;
    const json attributes = At(primitive, "attributes");
    const auto with_morphs = [&](const char* name) {
      std::optional<AccessorValues> values = file_.ReadAccessor(At(attributes, name));
      if (!values || values->components != 3) return std::optional<AccessorValues>();
      const json& targets = ListAt(primitive, "targets");
      for (std::size_t t = 0; t < std::min(weights.size(), targets.size()); ++t) {
        const auto target = weights[t] == 0 ? std::nullopt : file_.ReadAccessor(At(targets[t], name));
        if (!target || target->values.size() != values->values.size()) continue;
        for (std::size_t i = 0; i < values->values.size(); ++i) values->values[i] += weights[t] * target->values[i];
      }
      return values;
    };
    std::optional<AccessorValues> positions = with_morphs("POSITION");
    std::optional<AccessorValues> normals = with_morphs("NORMAL");
    if (!positions) return;
    if (!joints.empty()) ApplyJoints(attributes, joints, *positions, normals);
    primitive["attributes"]["POSITION"] = file_.AddAccessor(*positions);
    if (normals) primitive["attributes"]["NORMAL"] = file_.AddAccessor(*normals);
    primitive.erase("targets");
    std::erase_if(primitive["attributes"].get_ref<json::object_t&>(), [](const auto& attribute) {
      return attribute.first.starts_with("JOINTS_") || attribute.first.starts_with("WEIGHTS_");
    });
  }

  // glTF 2.0, 3.7.3.3: the weighted sum of the joints' transforms; the node's own does not count.
  void ApplyJoints(const json& attributes, const std::vector<Matrix4d>& joints, AccessorValues& positions,
                   std::optional<AccessorValues>& normals) {
    std::vector<Matrix4d> blended(positions.count(), Matrix4d::Zero());
    std::vector<double> total(positions.count(), 0.0);
    for (int set = 0; set < 4; ++set) {
      const auto of = file_.ReadAccessor(At(attributes, fmt::format("JOINTS_{}", set)));
      const auto weights = file_.ReadAccessor(At(attributes, fmt::format("WEIGHTS_{}", set)));
      if (!of || !weights || of->count() != positions.count() || weights->values.size() != of->values.size()) continue;
      for (std::size_t i = 0; i < of->values.size(); ++i) {
        const double joint = of->values[i];
        if (!(joint >= 0) || !(joint < static_cast<double>(joints.size()))) continue;
        blended[i / of->components] += weights->values[i] * joints[static_cast<std::size_t>(joint)];
        total[i / of->components] += weights->values[i];
      }
    }
    const bool has_normals = normals && normals->count() == positions.count();
    for (std::size_t i = 0; i < positions.count(); ++i) {
      const Matrix4d transform = total[i] > 0 ? Matrix4d(blended[i] / total[i]) : joints.front();
      Eigen::Map<Vector3d> position(positions.values.data() + 3 * i);
      position = (transform * position.homogeneous()).head<3>().eval();
      if (!has_normals) continue;
      Eigen::Map<Vector3d> normal(normals->values.data() + 3 * i);
      const Vector3d turned = transform.topLeftCorner<3, 3>().inverse().transpose() * normal;
      normal = turned.stableNormalized();
    }
  }

  // A mesh whose joints have placed it in the scene is drawn by a root node without a transform.
  void MoveToRoot(std::size_t n) {
    json& nodes = root()["nodes"];
    nodes.push_back({{"mesh", nodes[n]["mesh"]}});
    nodes[n].erase("mesh");
    for (json& scene : root()["scenes"]) {
      if (scene.is_object()) scene["nodes"].push_back(nodes.size() - 1);
    }
  }

  // Normalised and quantised attributes (KHR_mesh_quantization): the importer takes their bytes for floats.
  void UseFloats() {
    std::map<std::size_t, std::size_t> floats;
    for (json& mesh : root()["meshes"]) {
      if (!mesh.is_object() || !mesh.contains("primitives")) continue;
      for (json& primitive : mesh["primitives"]) {
        if (!primitive.is_object() || HasDraco(primitive) || !At(primitive, "attributes").is_object()) continue;
        for (const auto& [name, index] : primitive["attributes"].items()) {
          const bool is_geometry = name == "POSITION" || name == "NORMAL" || name.starts_with("TEXCOORD_");
          if (!is_geometry || file_.IsFloat(index)) continue;
          const auto integer = index.get<std::size_t>();
          if (!floats.contains(integer)) {
            const auto values = file_.ReadAccessor(index);
            if (!values || values->components > 4) continue;
            floats[integer] = file_.AddAccessor(*values);
          }
          index = floats[integer];
        }
      }
    }
    if (root()["meshes"].is_null()) root().erase("meshes");
  }

  // Root nodes at coordinates of a map, which 32 bits would round: the offset that is common to them goes.
  void MoveToOrigin() {
    std::vector<json*> roots;
    for (const json& scene : ListAt(root(), "scenes")) {
      for (const json& index : ListAt(scene, "nodes")) {
        json* node = file_.Find("nodes", index);
        if (node != nullptr && std::ranges::find(roots, node) == roots.end()) roots.push_back(node);
      }
    }
    std::optional<Vector3d> offset;
    for (json* node : roots) {
      const auto moved = Numbers<3>(At(*node, "translation"));
      if (!moved || node->contains("matrix")) return;
      if (!offset) offset = Vector3d(moved->data()).array().round();
      if (Vector3d(moved->data()).cwiseAbs().maxCoeff() < kMapCoordinate) return;
    }
    if (!offset) return;
    for (json* node : roots) {
      const Vector3d moved = Vector3d(Numbers<3>((*node)["translation"])->data()) - *offset;
      (*node)["translation"] = {moved.x(), moved.y(), moved.z()};
    }
  }

  void DropExtension(std::string_view name) {
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
      const auto found = root().find(list);
      if (found == root().end() || !found->is_array()) continue;
      json::array_t& names = found->get_ref<json::array_t&>();
      std::erase(names, json(name));
      if (names.empty()) root().erase(list);
    }
  }

  GltfFile& file_;
  std::vector<std::string> warnings_;
  std::vector<std::optional<std::size_t>> parents_;  // by node
};

}  // namespace

Expected<std::vector<std::string>> SimplifyGltf(GltfFile& file) { return Simplifier(file).Run(); }

}  // namespace victorious

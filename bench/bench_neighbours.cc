// The four nearest of a frame's descriptors for those of templates: our exhaustive search beside exhaustive and
// approximate ones of other libraries. Each frame is new, so that an index of it has to be built for each frame.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <faiss/IndexFlat.h>
#include <faiss/IndexHNSW.h>
#include <faiss/IndexIVFFlat.h>
#include <hnswlib/hnswlib.h>
#include <opencv2/features2d.hpp>
#include <opencv2/flann.hpp>

#include "bench/benchmarks.h"
#include "bench/workloads.h"
#include "victorious/kernels/nearest.h"

// Of the OpenMP that faiss is compiled with.
extern "C" {
int omp_get_max_threads();
void omp_set_num_threads(int count);
}

namespace victorious::bench {
namespace {

constexpr std::size_t kNearest = 4;
constexpr auto kDimensions = static_cast<int>(kDescriptorSize);
// Of the approximate indexes: with these, each finds the nearest in nearly nine of ten cases.
constexpr std::size_t kCells = 64;  // of the inverted file
constexpr std::size_t kProbedCells = 5;
constexpr int kLinks = 12;  // of a node in the graph
constexpr int kBuildCandidates = 40;
constexpr int kSearchCandidates = 16;
constexpr int kTrees = 4;
constexpr int kChecks = 384;

// For each query the kNearest indices into the set, nearest first.
using Found = std::vector<std::size_t>;

// A library's search, and how long its index takes to build.
struct Peer {
  std::string name;
  double build_ms;
  std::function<Found()> find;
};

double Milliseconds(const std::function<void()>& run) {
  const auto start = std::chrono::steady_clock::now();
  run();
  return MillisecondsSince(start);
}

Found FromLabels(std::span<const faiss::Index::idx_t> labels) { return {labels.begin(), labels.end()}; }

// @param index  of the set
// @param set, queries  CV_32F, a row a descriptor
Peer MakeFaissPeer(std::string name, const std::shared_ptr<faiss::Index>& index, const cv::Mat& set,
                   const cv::Mat& queries) {
  const double build_ms = Milliseconds([&] {
    index->train(set.rows, set.ptr<float>());
    index->add(set.rows, set.ptr<float>());
  });
  return {std::move(name), build_ms, [index, queries] {
            const std::size_t count = static_cast<std::size_t>(queries.rows) * kNearest;
            std::vector<float> distances(count);
            std::vector<faiss::Index::idx_t> labels(count);
            index->search(queries.rows, queries.ptr<float>(), kNearest, distances.data(), labels.data());
            return FromLabels(labels);
          }};
}

Peer MakeHnswlibPeer(const cv::Mat& set, const cv::Mat& queries) {
  struct Index {
    hnswlib::L2Space space{kDescriptorSize};
    hnswlib::HierarchicalNSW<float> graph;
    explicit Index(std::size_t count) : graph(&space, count, kLinks, kBuildCandidates) {}
  };
  const auto index = std::make_shared<Index>(static_cast<std::size_t>(set.rows));
  const double build_ms = Milliseconds([&] {
    for (int i = 0; i < set.rows; ++i) index->graph.addPoint(set.ptr<float>(i), static_cast<std::size_t>(i));
    index->graph.setEf(kSearchCandidates);
  });
  return {"hnswlib", build_ms, [index, queries] {
            Found found(static_cast<std::size_t>(queries.rows) * kNearest);
            for (int q = 0; q < queries.rows; ++q) {
              auto nearest = index->graph.searchKnn(queries.ptr<float>(q), kNearest);  // the farthest on top
              for (std::size_t rank = nearest.size(); rank-- > 0; nearest.pop()) {
                found[static_cast<std::size_t>(q) * kNearest + rank] = nearest.top().second;
              }
            }
            return found;
          }};
}

Peer MakeFlannPeer(const cv::Mat& set, const cv::Mat& queries) {
  std::shared_ptr<cv::flann::Index> index;
  const double build_ms =
      Milliseconds([&] { index = std::make_shared<cv::flann::Index>(set, cv::flann::KDTreeIndexParams(kTrees)); });
  return {"flann", build_ms, [index, queries] {
            cv::Mat labels;
            cv::Mat distances;
            index->knnSearch(queries, labels, distances, kNearest, cv::flann::SearchParams(kChecks));
            return Found(labels.begin<int>(), labels.end<int>());
          }};
}

Peer MakeBruteForcePeer(const cv::Mat& set, const cv::Mat& queries) {
  return {"opencv_bfmatcher", 0, [set, queries] {
            std::vector<std::vector<cv::DMatch>> nearest;
            cv::BFMatcher(cv::NORM_L2).knnMatch(queries, set, nearest, kNearest);
            Found found;
            for (const std::vector<cv::DMatch>& one : nearest) {
              for (const cv::DMatch& match : one) found.push_back(static_cast<std::size_t>(match.trainIdx));
            }
            return found;
          }};
}

Found FindOurs(const kernels::PackedQueries& queries, const kernels::PackedDescriptors& set) {
  std::vector<kernels::Neighbour> nearest(queries.count * kNearest);
  kernels::FindNearestK(queries, set, kNearest, nearest);
  Found found;
  for (const kernels::Neighbour& one : nearest) found.push_back(one.index);
  return found;
}

// The fraction of queries whose nearest is found.
double Recall(const Found& found, const Found& exact) {
  std::size_t same = 0;
  for (std::size_t i = 0; i < exact.size(); i += kNearest) same += found[i] == exact[i] ? 1 : 0;
  return static_cast<double>(same) / (static_cast<double>(exact.size()) / kNearest);
}

}  // namespace

std::vector<Result> BenchNeighbours(const Settings& settings) {
  const testing::SyntheticFlight flight = MakeSyntheticFlight();
  const FeatureSet scene = ExtractFromFrames(flight, settings.quick ? 1 : 4);
  const std::vector<ObjectModel> models = MakeAllRoundModels(flight, 25);
  const FeatureSet templates = Concatenate(CollectViews(models));
  const cv::Mat set = FloatDescriptors(scene.View());
  const cv::Mat queries = FloatDescriptors(templates.View());

  const int threads_before = omp_get_max_threads();
  omp_set_num_threads(1);  // of faiss
  const auto quantizer = std::make_shared<faiss::IndexFlatL2>(kDimensions);
  const auto inverted = std::make_shared<faiss::IndexIVFFlat>(quantizer.get(), kDimensions, kCells);
  inverted->nprobe = kProbedCells;
  inverted->cp.min_points_per_centroid = 1;  // no warning of few descriptors
  const auto graph = std::make_shared<faiss::IndexHNSWFlat>(kDimensions, kLinks);
  graph->hnsw.efConstruction = kBuildCandidates;
  graph->hnsw.efSearch = kSearchCandidates;
  const std::vector<Peer> peers = {
      MakeBruteForcePeer(set, queries),
      MakeFaissPeer("faiss_flat", std::make_shared<faiss::IndexFlatL2>(kDimensions), set, queries),
      MakeFaissPeer("faiss_ivf", inverted, set, queries),
      MakeFaissPeer("faiss_hnsw", graph, set, queries),
      MakeHnswlibPeer(set, queries),
      MakeFlannPeer(set, queries)};

  const kernels::PackedQueries packed = kernels::PackQueries(templates.descriptors);
  kernels::PackedDescriptors packed_set;
  const double pack_ms = Milliseconds([&] { packed_set = kernels::Pack(scene.descriptors); });
  const Found exact = FindOurs(packed, packed_set);
  std::vector<Implementation> implementations;
  for (const Peer& peer : peers) {
    implementations.push_back({peer.name, [&peer] { return static_cast<double>(peer.find().front()); }});
  }
  Result result =
      Compare("neighbours", {"victorious", [&] { return static_cast<double>(FindOurs(packed, packed_set).front()); }},
              implementations, settings.effort());
  result.figures = {{"keypoints", static_cast<double>(scene.size())},
                    {"descriptors", static_cast<double>(packed.count)},
                    {"build_ms", pack_ms}};
  for (const Peer& peer : peers) {
    result.figures.emplace_back("build_ms_" + peer.name, peer.build_ms);
    result.figures.emplace_back("recall_" + peer.name, Recall(peer.find(), exact));
  }
  omp_set_num_threads(threads_before);
  return {result};
}

}  // namespace victorious::bench

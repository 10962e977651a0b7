// The choice among tracks of lobes: the cheapest path, and the fading of its edges.
#include "models/su/view_tracks.h"

#include "properties.h"

namespace srbf::view_tracks_test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Path = std::vector<std::size_t>;

double cost_of(const Path& path, const std::vector<VectorXd>& cost, const std::vector<MatrixXd>& between) {
    double sum = 0;
    for (std::size_t i = 0; i < path.size(); ++i) {
        sum += cost[i][Index(path[i])];
        if (i > 0) sum += between[i - 1](Index(path[i - 1]), Index(path[i]));
    }
    return sum;
}

TEST(ViterbiPath, IsTheCheapestOfAll) {
    std::mt19937_64 random(1);
    constexpr std::size_t views = 6, tracks = 3, paths = 729;
    for (int round = 0; round < 50; ++round) {
        std::vector<VectorXd> cost;
        std::vector<MatrixXd> between;
        for (std::size_t i = 0; i < views; ++i)
            cost.push_back(VectorXd::NullaryExpr(tracks, [&] { return uniform(random); }));
        for (std::size_t i = 0; i + 1 < views; ++i)
            between.push_back(MatrixXd::NullaryExpr(tracks, tracks, [&] { return 2 * uniform(random); }));
        double least = INFINITY;
        for (std::size_t code = 0; code < paths; ++code) {
            Path path;
            for (std::size_t i = 0, rest = code; i < views; ++i, rest /= tracks) path.push_back(rest % tracks);
            least = std::min(least, cost_of(path, cost, between));
        }
        EXPECT_TRUE(near_relative(cost_of(viterbi_path(cost, between), cost, between), least, 1e-12));
    }
    EXPECT_TRUE(viterbi_path({}, {}).empty());
    EXPECT_EQ(viterbi_path(std::vector<VectorXd>{VectorXd{{2, 1}}}, {}), Path{1});
}

/// Two tracks with a large edge between them; the second is the better one from the middle on.
struct TwoTracks {
    std::size_t views = 401, middle = 200;
    std::vector<VectorXd> cost;
    std::vector<MatrixXd> between;
    explicit TwoTracks(double dearer) {
        for (std::size_t i = 0; i < views; ++i)
            cost.push_back(i < middle ? VectorXd{{1, dearer}} : VectorXd{{dearer, 1}});
        between.assign(views - 1, MatrixXd{{0.1, 1}, {1, 0.1}});
    }
    Path path() const {
        Path path(views, 0);
        std::fill(path.begin() + std::ptrdiff_t(middle), path.end(), 1);
        return path;
    }
};

constexpr std::size_t k_most = 64;

TEST(Faded, PassesFromOneTrackToTheOther) {
    const TwoTracks two(1.2);
    ASSERT_EQ(viterbi_path(two.cost, two.between), two.path());
    const Path faded_path = faded(two.path(), two.cost, two.between, k_most);
    // In windows of sixteen views the share of the second rises from none to all, by little from one to the next.
    double last = 0;
    for (std::size_t i = 0; i + 16 <= two.views; ++i) {
        const auto begin = faded_path.begin() + std::ptrdiff_t(i);
        const double share = double(std::count(begin, begin + 16, 1u)) / 16;
        EXPECT_GE(share, last - 0.1) << i;
        EXPECT_LE(share, last + 0.1) << i;
        last = std::max(last, share);
    }
    EXPECT_EQ(last, 1);
    for (std::size_t i = 0; i < two.views / 4; ++i) {
        EXPECT_EQ(faded_path[i], 0u);
        EXPECT_EQ(faded_path[two.views - 1 - i], 1u);
    }
}

TEST(Faded, FadesTheLargestEdgeFirst) {
    TwoTracks two(1.2);
    const Path expected = faded(two.path(), two.cost, two.between, k_most);
    two.between[two.middle - 10](0, 0) = 0.3;  // seen too, and on the way
    EXPECT_EQ(faded(two.path(), two.cost, two.between, k_most), expected);
}

TEST(Faded, LeavesWhatCannotBeContinued) {
    const TwoTracks dear(3);
    EXPECT_EQ(faded(dear.path(), dear.cost, dear.between, k_most), dear.path());
    TwoTracks alike(1.2);
    alike.between.assign(alike.views - 1, MatrixXd::Constant(2, 2, 0.1));  // nothing is seen of the edge
    EXPECT_EQ(faded(alike.path(), alike.cost, alike.between, k_most), alike.path());
    TwoTracks broken(1.2);
    for (auto& edges : broken.between) edges = MatrixXd{{1, 1}, {1, 0.1}};  // neither goes on where the other is
    for (std::size_t i = 0; i < broken.middle; ++i) broken.between[i](0, 0) = 0.1, broken.between[i](1, 1) = 1;
    EXPECT_EQ(faded(broken.path(), broken.cost, broken.between, k_most), broken.path());
    EXPECT_TRUE(faded({}, {}, {}, k_most).empty());
}

}  // namespace
}  // namespace srbf::view_tracks_test

#include "identifiability.hpp"

#include <algorithm>
#include <cmath>

namespace brushsvg::fit {
namespace {

constexpr double kMaxMeasuredSd = 0.25;  // of a law's size: a law with a larger standard deviation is not measured

struct Group {
    std::string name;
    int begin, count;
};

/// A direction of the unknowns that the marks do not determine, with its standard deviation. The information is over
/// the shared unknowns, in units of their sizes.
struct OpenDirection {
    double sd;
    VectorXd direction;
};
std::vector<OpenDirection> find_open_directions(const MatrixXd& information) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(information);
    std::vector<OpenDirection> out;
    for (Index i = 0; i < information.rows(); ++i) {
        const double sd = 1.0 / std::sqrt(std::max(1e-30, eigen.eigenvalues()[i]));
        if (sd > kMaxMeasuredSd) out.push_back({sd, eigen.eigenvectors().col(i)});
    }
    return out;
}

double sd_along(const MatrixXd& information, const VectorXd& direction) {
    return 1.0 / std::sqrt(std::max(1e-30, direction.dot(information * direction)));
}

}  // namespace

std::vector<std::string> describe_open_unknowns(const MarkProblem& fit) {
    const MarkModel& model = fit.model;
    const VectorXd& shared = fit.shared;
    const Layout& at = model.layout();
    const double noise_mm =
        fit.weighing.noise_mm * std::sqrt(fit.weighing.points_per_independent);  // noise of one independent sample
    const Index n = at.shift();  // displacements cannot determine the place of the sheet, and need not
    // Information from marks whose places are known, and from marks that may be displaced.
    MatrixXd placed_information = MatrixXd::Zero(n, n), displaced_information = placed_information;
    for (Index i = 0; i < model.marks(); ++i) {
        RowMajor by(model.points(i), at.size()), own(model.points(i), 2);
        VectorXd distance;
        if (!model.distances(i, shared.data(), fit.displacements_mm[std::size_t(i)].data(), distance, &by, &own))
            continue;
        const VectorXd weight = fit.point_weights[std::size_t(i)] / noise_mm;
        const MatrixXd laws = weight.asDiagonal() * by.leftCols(n), place = weight.asDiagonal() * own;
        const MatrixXd between = place.transpose() * laws;
        placed_information += laws.transpose() * laws;
        displaced_information +=
            laws.transpose() * laws -
            between.transpose() * (place.transpose() * place).completeOrthogonalDecomposition().solve(between);
    }
    // Sizes of the laws are their greatest values. The size of the height moves the widest mark by a quarter.
    VectorXd size(n);
    const double lag = std::max(0.5, shared.head(at.lag).maxCoeff());
    const double half = std::max(0.1, shared.segment(at.half_at(), at.half).sum());
    size.head(at.lag).setConstant(lag);
    size.segment(at.gap_at(), at.gap).setConstant(std::max(half, std::abs(shared.segment(at.gap_at(), at.gap).sum())));
    size.segment(at.half_at(), at.half).setConstant(half);
    size.segment(at.widest(), at.widest_terms).setConstant(std::max(1.0, shared[at.widest()]));
    size.segment(at.front(), at.front_terms).setConstant(std::max(1.0, shared[at.front()]));
    size[at.height()] = 1.0;
    placed_information = size.asDiagonal() * placed_information * size.asDiagonal();
    displaced_information = size.asDiagonal() * displaced_information * size.asDiagonal();

    const std::vector<Group> groups{{"lag", 0, at.lag},
                                    {"tip_gap", at.gap_at(), at.gap},
                                    {"half_width", at.half_at(), at.half},
                                    {"the footprint's shape", at.widest(), at.height() - at.widest()},
                                    {"the height of the paper", at.height(), 1}};
    std::vector<std::string> out;
    const auto add_sentence = [&](const std::string& sentence) {
        if (std::find(out.begin(), out.end(), sentence) == out.end()) out.push_back(sentence);
    };
    for (const OpenDirection& open : find_open_directions(displaced_information)) {
        std::vector<std::pair<double, std::string>> shares;
        for (const Group& group : groups)
            shares.emplace_back(open.direction.segment(group.begin, group.count).squaredNorm(), group.name);
        std::sort(shares.rbegin(), shares.rend());
        std::string unknown_name = shares[0].second;
        const bool two = shares[1].first > 0.15;
        if (sd_along(placed_information, open.direction) < 0.5 * kMaxMeasuredSd)
            add_sentence("these strokes cannot separate " + unknown_name +
                         " from the displacement of each mark: add curved strokes, corners or reversals");
        else if (two)
            add_sentence("these strokes cannot separate " + unknown_name + " from " + shares[1].second +
                         ": paint at more depths, with corners and reversals at each");
        else if (unknown_name == "lag" && at.lag > 1)
            add_sentence(
                "these strokes do not show how the lag changes with depth: paint curved strokes at more depths");
        else
            add_sentence("these strokes do not determine " + unknown_name +
                         ": add corners, reversals and ends that are lifted in place, at more depths");
    }
    return out;
}

}  // namespace brushsvg::fit

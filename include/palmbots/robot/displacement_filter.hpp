// SPDX-License-Identifier: Apache-2.0
// The likelihood of measured displacements of a robot: a Kalman filter with the states displacement
// s and noise of the speed n, for many models at once. docs of the model, of what is filtered and of
// the sums: src/palmbots/fitting/motion_likelihood.py.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace palmbots {

// Stretches in which a robot drives, one after the other, as arrays of a row for each position.
struct DisplacementChain {
  std::size_t length;
  const double* steps;          // time since the position before [s]
  const double* measured;       // of each position: displacement beyond the command, and time
  const unsigned char* starts;  // whether a stretch begins: its place is new, the noise has gone on
};

// Errors of the speed: correlation time, variance of n, growth of the variance of s, and variance of
// the positions.
struct DisplacementModel {
  double tau, variance, diffusion, of_position;
};

// Σ log T, Σ y²/T, Σ y t/T and Σ t²/T; y and t are what the two measured columns deviate from their
// predictions, with the variance T.
using DisplacementSums = std::array<double, 4>;

class DisplacementFilter {
 public:
  explicit DisplacementFilter(const std::vector<DisplacementModel>& models)
      : models_(models), lanes_(models.size()) {}

  // The sums of each model. `errors`, if any, gets T, y and t of the first model for each position.
  std::vector<DisplacementSums> filter(const DisplacementChain& chain, double* errors = nullptr) {
    const std::size_t count = models_.size();
    std::vector<DisplacementSums> sums(count, DisplacementSums{});
    for (std::size_t i = 0; i < count; ++i) lanes_[i] = Lane::of(models_[i]);
    double last = -1.0;
    for (std::size_t k = 1; k < chain.length; ++k) {
      const double h = chain.steps[k];
      if (h != last) {
        for (std::size_t i = 0; i < count; ++i) lanes_[i].change(models_[i], h);
        last = h;
      }
      const bool starts = chain.starts[k] != 0;
      const double y = chain.measured[2 * k], t = chain.measured[2 * k + 1];
      for (std::size_t i = 0; i < count; ++i) lanes_[i].step(models_[i].of_position, y, t, starts);
      if (errors != nullptr && count > 0) {
        const Lane& lane = lanes_[0];
        errors[3 * k] = lane.total, errors[3 * k + 1] = lane.y, errors[3 * k + 2] = lane.t;
      }
      // Logarithms are slow: one of a product of eight, which cannot underflow.
      if (k % 8 == 0 || k + 1 == chain.length) {
        for (Lane& lane : lanes_) lane.take_log();
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      sums[i] = {lanes_[i].logs, lanes_[i].yy, lanes_[i].yt, lanes_[i].tt};
    }
    return sums;
  }

 private:
  struct Lane {
    double s_y = 0, s_t = 0, n_y = 0, n_t = 0;             // means, of both measured columns
    double ss = 0, sn = 0, nn = 0;                         // covariances
    double a = 0, c = 0, of_ss = 0, of_sn = 0, of_nn = 0;  // what a step changes
    double total = 1, y = 0, t = 0;                        // T and the errors of the last position
    double product = 1, logs = 0, yy = 0, yt = 0, tt = 0;

    static Lane of(const DisplacementModel& model) {
      Lane lane;
      lane.ss = model.of_position;
      lane.nn = model.variance;
      return lane;
    }

    // n decays by a = e^(−h/τ) and adds c n to s; what the drawn part of n adds to the covariances.
    void change(const DisplacementModel& model, double h) {
      const double tau = model.tau, x = h / tau, lost = -std::expm1(-x);
      const double brief = x * x * x * (2.0 / 3 - x * (0.5 - x * (7.0 / 30)));  // without rounding
      const double added = x < 1e-2 ? brief : 2 * x - lost * (2 + lost);
      a = 1 - lost;
      c = tau * lost;
      of_ss = model.variance * tau * tau * added + model.diffusion * h;
      of_sn = model.variance * tau * lost * lost;
      of_nn = model.variance * lost * (2 - lost);
    }

    void step(double of_position, double measured_y, double measured_t, bool starts) {
      s_y += c * n_y;
      s_t += c * n_t;
      n_y *= a;
      n_t *= a;
      const double of_s = sn + c * nn;
      ss += c * (sn + of_s) + of_ss;
      sn = a * of_s + of_sn;
      nn = a * a * nn + of_nn;
      total = ss + of_position;
      y = measured_y - s_y;
      t = measured_t - s_t;
      if (starts) {  // a flat prior of the place: as if the position were known
        s_y = s_t = y = t = sn = 0.0;
        total = 1.0;
      }
      const double inverse = 1.0 / total, part_y = y * inverse, part_t = t * inverse;
      product *= total;
      yy += y * part_y;
      yt += y * part_t;
      tt += t * part_t;
      s_y += ss * part_y;
      s_t += ss * part_t;
      n_y += sn * part_y;
      n_t += sn * part_t;
      nn -= sn * sn * inverse;
      const double rest = of_position * inverse;
      ss = starts ? of_position : rest * ss;
      sn *= rest;
    }

    void take_log() {
      logs += std::log(product);
      product = 1.0;
    }
  };

  std::vector<DisplacementModel> models_;
  std::vector<Lane> lanes_;
};

}  // namespace palmbots

// SPDX-License-Identifier: MIT
// How long is waited for what, in seconds.
#pragma once

namespace pafas {

struct Timing {
  double alive = 1;          ///< between signs of life of a slave
  double ask_again = 5;      ///< without an answer
  double relay = 1;          ///< without a piece of the package from another slave
  double keep_package = 30;  ///< for others, after the last of them has asked
  double hold = 2;           ///< that a slave holds results back at most
  double patience = 120;     ///< of a slave that hears nothing from the master
  double silence = 10;       ///< after which a slave is lost
  double last_blocks = 4;    ///< for the blocks that a slave has at hand at the end
  double reports = 6;        ///< that the master waits for reports
  double last_results = 1;   ///< for results on their way when the run is stopped
};

}  // namespace pafas

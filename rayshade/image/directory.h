// SPDX-License-Identifier: MIT
// What concerns the folder that files are written in: names that last, and hidden files left behind by
// processes that were killed.
#pragma once

#include <string>
#include <vector>

namespace rayshade {

/// "a/b.png" -> "a/"; empty for a file of the current folder.
std::string directory_of(const std::string& path);

/// `path` with the symbolic links of its last component followed, so that the link stays and its target is
/// replaced.
std::string follow_links(std::string path);

/// The hidden file of OutputFile for a target: "a/b.png" -> "a/.b.png.HOST.PID.ATTEMPT.tmp" with the number
/// of this process. HOST is a checksum of the machine's name: numbers of processes mean nothing on another
/// one.
std::string temporary_name(const std::string& target, int attempt);

/// Removes the hidden files that processes of this machine left behind when they were killed, of any of these
/// targets: regular files whose names are exactly those of temporary_name for a process that does not live.
/// Before this process opens the first of them: what has its number is of an earlier one of that number.
/// Returns how many; never throws: what cannot be removed stays.
int remove_leftovers(const std::vector<std::string>& targets) noexcept;

/// Afterwards the folder of `path` names on the disk what it names now. False where it cannot be synced.
bool sync_directory_of(const std::string& path);

}  // namespace rayshade

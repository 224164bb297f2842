# SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
# SPDX-License-Identifier: Apache-2.0
#
# Tab completion of rtd for bash: `. deploy/completion/rtd.bash`. The package installs it.

_rtd() {
  local words word candidates
  read -ra words <<<"${COMP_LINE:0:COMP_POINT}"
  [[ "${COMP_LINE:0:COMP_POINT}" == *' ' ]] && words+=('')
  word=${words[-1]}
  mapfile -t candidates < <("${words[0]}" complete "${words[@]:1}" 2>/dev/null)
  COMPREPLY=("${candidates[@]}")
  # bash takes ':' and '=' for ends of words: what comes before the last one is not to be repeated.
  if [[ "$word" == *[:=]* ]]; then
    COMPREPLY=("${COMPREPLY[@]#"${word%"${word##*[:=]}"}"}")
  fi
  if [[ ${#COMPREPLY[@]} -eq 1 && "${COMPREPLY[0]}" == *[:=] ]]; then
    compopt -o nospace
  fi
}
complete -o default -F _rtd rtd

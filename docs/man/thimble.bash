# Completion of thimble(1) for bash; bash-completion loads it by its name.

_thimble_arms() {
  thimble "$@" status 2>/dev/null | sed -n 's/^arm \([a-z0-9-]*\) .*/\1/p'
}

_thimble() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}
  local commands="status watch report doctor devices flight cam activate deactivate clear-fault impedance calibrate-force world snapshot lab select drop delete free reset"
  local options="--help --socket" command= socket=() i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    if [[ ${COMP_WORDS[i]} == --socket ]]; then
      ((++i < COMP_CWORD)) && socket=(--socket "${COMP_WORDS[i]}")
    elif [[ -z $command && " $commands " == *" ${COMP_WORDS[i]} "* ]]; then
      command=${COMP_WORDS[i]}
    fi
  done
  COMPREPLY=()
  case $before in
    --socket | --plugin | --config | --file) mapfile -t COMPREPLY < <(compgen -f -- "$word"); return ;;
    --root) mapfile -t COMPREPLY < <(compgen -d -- "$word"); return ;;
    --interval | --for | --before | --min | --max | --center | --radius | --cell | --fault | --most | --steps) return ;;
    --clock-mhz) mapfile -t COMPREPLY < <(compgen -W "20 21 25" -- "$word"); return ;;
    --sites) mapfile -t COMPREPLY < <(compgen -W "22 24" -- "$word"); return ;;
  esac
  case $command in
    "") options="--help --version --socket $commands" ;;
    status) options+=" --json" ;;
    watch) options+=" --interval --for" ;;
    doctor) options+=" --json --root --plugin --config" ;;
    devices) options+=" --json --toml --root --plugin" ;;
    flight)
      if [[ $word == -* ]]; then
        options+=" --before"
      elif [[ " ${COMP_WORDS[*]:0:COMP_CWORD} " == *" show "* ]]; then
        mapfile -t COMPREPLY < <(compgen -f -- "$word"); return
      else
        options=show
      fi ;;
    cam)
      if [[ $before == --engine ]]; then
        options="reference general compiled auto"
      elif [[ $before == --pattern || $before == --write ]]; then
        mapfile -t COMPREPLY < <(compgen -f -- "$word"); return
      elif [[ $word == -* && " ${COMP_WORDS[*]:0:COMP_CWORD} " == *" run "* ]]; then
        options+=" --size --steps --seed --pattern --engine --threads --modules --clock-mhz --write --json"
      elif [[ $word == -* && " ${COMP_WORDS[*]:0:COMP_CWORD} " == *" list "* ]]; then
        options+=" --json"
      elif [[ $word == -* ]]; then
        options+=" --sync --sites"
      elif [[ " ${COMP_WORDS[*]:0:COMP_CWORD} " == *" disassemble "* ]]; then
        mapfile -t COMPREPLY < <(compgen -f -- "$word"); return
      else
        options="run list disassemble"
      fi ;;
    world)
      if [[ $word == -* ]]; then
        options+=" --min --max --center --radius --cell --file"
      elif [[ $before == world ]]; then
        options="fill clear box paint save load"
      else
        options=
      fi ;;
    snapshot)
      [[ $word == -* ]] && options+=" --file" || options= ;;
    lab)
      if [[ $before == --write || $before == --out || ( $before == run && $word != -* ) ]]; then
        mapfile -t COMPREPLY < <(compgen -f -- "$word"); return
      elif [[ $word != -* ]]; then
        options="cam-latency separate compare compare-moving compare-guarded compare-moving-guarded compare-two-port compare-moving-two-port constraint-models teleoperation stability hello-sphere drift run table-4.1"
      elif [[ " ${COMP_WORDS[*]:0:COMP_CWORD} " == *" table-4.1 "* ]]; then
        options+=" --seed --contacts --out"
      elif [[ " ${COMP_WORDS[*]:0:COMP_CWORD} " =~ " "(compare|compare-moving|compare-guarded|compare-moving-guarded|compare-two-port|compare-moving-two-port|teleoperation|stability|hello-sphere|drift)" " ]]; then
        options+=" --seed --out"
      elif [[ " ${COMP_WORDS[*]:0:COMP_CWORD} " == *" constraint-models "* ]]; then
        options+=" --seed --out"
      elif [[ " ${COMP_WORDS[*]:0:COMP_CWORD} " == *" run "* ]]; then
        options+=" --set --seed --for --out"
      elif [[ " ${COMP_WORDS[*]:0:COMP_CWORD} " == *" separate "* ]]; then
        options+=" --seed --write"
      else
        options+=" --clock-mhz"
      fi ;;
    select | drop | delete) [[ $word == -* ]] || options= ;;
    report) [[ $word == -* ]] || { mapfile -t COMPREPLY < <(compgen -f -- "$word"); return; } ;;
    clear-fault) [[ $word == -* ]] && options+=" --fault" || options=$(_thimble_arms "${socket[@]}") ;;
    calibrate-force) [[ $word == -* ]] && options+=" --most --steps" || options=$(_thimble_arms "${socket[@]}") ;;
    *) [[ $word == -* ]] || options=$(_thimble_arms "${socket[@]}") ;;
  esac
  mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
}

complete -o filenames -F _thimble thimble

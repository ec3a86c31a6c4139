# Completion of thimble-simdev(1) for bash; bash-completion loads it by its name.

_thimble_simdev() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}
  COMPREPLY=()
  case $before in
    --socket | --plugin) mapfile -t COMPREPLY < <(compgen -f -- "$word"); return ;;
    --usbip | --serial | --amplifier-max-a | --frames-at-once | --slices-per-frame | --seed) return ;;
  esac
  mapfile -t COMPREPLY < <(compgen -W "--help --version --uhid --vhci --usbip --socket --plugin --serial --amplifier-max-a --frames-at-once --slices-per-frame --seed" -- "$word")
}

complete -o filenames -F _thimble_simdev thimble-simdev

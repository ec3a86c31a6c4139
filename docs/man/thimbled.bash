# Completion of thimbled(8) for bash; bash-completion loads it by its name.

_thimbled() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}
  COMPREPLY=()
  case $before in
    --config | --summary) mapfile -t COMPREPLY < <(compgen -f -- "$word"); return ;;
    --set | --for) return ;;
  esac
  mapfile -t COMPREPLY < <(compgen -W "--help --version --config --set --check --for --summary" -- "$word")
}

complete -o filenames -F _thimbled thimbled

!> Sequentially linear analysis: loads, batches of events and the state of a model of api_sla_model.
!>
!> Nodes, elements and points are 1-based.
module api_sla
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: loads, supports, reactions, stop_at, run, relax, displacement, measure, report, damage, set_damage
   public :: standing, resume, follow, continues, histories, go_on

contains

   !> Start a stage; the ledger goes on from the energies so far
   subroutine loads(handle, freedoms, nodes, load_a, load_b, carried, events, external, dissipated, cracked, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use sla_handle, only : model_take, stage_factored, stage_loaded
      use sla_model, only : element_model, model_loads
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: freedoms            !! of a node
      integer(c_int), intent(in) :: nodes
      real(c_double), intent(in) :: load_a(freedoms, nodes)    !! [N], [N m]
      real(c_double), intent(in) :: load_b(freedoms, nodes)    !! [N], [N m]
      integer(c_int), intent(in) :: carried             !! 1: the work of A is in the ledger
      integer(c_int), intent(in) :: events              !! so far
      real(c_double), intent(in) :: external            !! work so far [J]
      real(c_double), intent(in) :: dissipated          !! energy so far [J]
      real(c_double), intent(in) :: cracked             !! energy of cracks so far [J]
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      !f2py threadsafe
      call model_take(handle, stage_factored, stage_loaded, model, status)
      if (status /= status_ok) return
      if (nodes /= model%mesh%nodes .or. freedoms /= size(model%mesh%equation, 1) .or. events < 0) then
         status = status_invalid_argument
      else
         model%loop%events = int(events)
         model%ledger%external = external
         model%ledger%dissipated = dissipated
         model%ledger%cracked = cracked
         call model_loads(model, load_a, load_b, carried /= 0, status)
         if (status == status_ok) model%stage = stage_loaded
      end if
      call handle_leave(handle)
   end subroutine loads

   !> Displacements of the supports that move, for the loads that are set next
   subroutine supports(handle, count, moved, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use sla_handle, only : model_take, stage_factored, stage_loaded
      use sla_model, only : element_model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: count
      real(c_double), intent(in) :: moved(count, 2)     !! constant and per multiplier [m]
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      call model_take(handle, stage_factored, stage_loaded, model, status)
      if (status /= status_ok) return
      if (count /= size(model%support%moved, 1)) then
         status = status_invalid_argument
      else
         model%support%moved(:, :) = moved
         model%stage = stage_factored
      end if
      call handle_leave(handle)
   end subroutine supports

   !> Forces of the supports that move
   subroutine reactions(handle, count, force, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use sla_handle, only : model_take, stage_loaded
      use sla_model, only : element_model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: count
      real(c_double), intent(out) :: force(count, 2)    !! under A and per multiplier [N], as the batch before left them
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      force = 0.0_c_double
      call model_take(handle, stage_loaded, stage_loaded, model, status)
      if (status /= status_ok) return
      if (count /= size(model%support%moved, 1)) then
         status = status_invalid_argument
      else
         force = model%support%reaction
      end if
      call handle_leave(handle)
   end subroutine reactions

   !> Where the next batches of events end and how they go on without equilibrium, see stop_rules of sla_state
   subroutine stop_at(handle, variant, load, displacement, fraction, compliance, refuse_overload, target, side, &
                      already, far, status)
      use common_handles, only : handle_leave
      use common_lists, only : proportional => sla_variant_proportional, release => sla_variant_force_release
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_new, stage_loaded
      use sla_model, only : element_model
      use sla_state, only : stop_rules
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: variant            !! list sla_variant
      real(c_double), intent(in) :: load               !! multiplier carried
      real(c_double), intent(in) :: displacement       !! of monitor 1 [m]
      real(c_double), intent(in) :: fraction           !! of the peak
      real(c_double), intent(in) :: compliance         !! over the first
      integer(c_int), intent(in) :: refuse_overload
      real(c_double), intent(in) :: target             !! of monitor 1 [m]
      real(c_double), intent(in) :: side               !! from which the target is reached
      real(c_double), intent(in) :: already            !! loads like B that are on
      real(c_double), intent(in) :: far                !! greatest way of monitor 1 [m]
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      call model_take(handle, stage_new, stage_loaded, model, status)
      if (status /= status_ok) return
      model%rules = stop_rules(continues=model%rules%continues, lambda=load, &
         displacement=displacement, fraction=fraction, compliance=compliance, &
         refuse_overload=refuse_overload /= 0, proportional=variant == proportional, release=variant == release, &
         target=target, side=side, already=already, far=far)
      call handle_leave(handle)
   end subroutine stop_at

   !> How the next batches go on where events find no equilibrium, see equilibrium_path of sla_state
   subroutine follow(handle, how, longest, least, unit, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use sla_handle, only : model_take, stage_new, stage_loaded
      use sla_model, only : element_model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: how                !! 0 not at all, 1 Newton and staggered, 2 implicit-explicit, 3 arc length
      real(c_double), intent(in) :: longest            !! step of the control [m]
      real(c_double), intent(in) :: least              !! displacement below which nothing runs away [m]
      real(c_double), intent(in) :: unit               !! resultant of the reference load, 1 where supports move [N]
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      call model_take(handle, stage_new, stage_loaded, model, status)
      if (status /= status_ok) return
      if (how < 0 .or. how > 3 .or. .not. longest > 0.0_c_double .or. .not. unit > 0.0_c_double) then
         status = status_invalid_argument
      else
         model%rules%continues = how > 0
         model%path%implicit = how /= 2
         model%path%by_energy = how == 3
         model%path%unit = unit
         model%path%longest = longest * unit
         model%path%least_runaway = least
      end if
      call handle_leave(handle)
   end subroutine follow

   !> Can all groups be followed by equilibrium iterations?
   subroutine continues(handle, yes, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_continuation, only : model_continues
      use sla_handle, only : model_take, stage_prepared, stage_loaded
      use sla_model, only : element_model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(out) :: yes
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      yes = 0
      call model_take(handle, stage_prepared, stage_loaded, model, status)
      if (status /= status_ok) return
      yes = merge(1_c_int, 0_c_int, model_continues(model))
      call handle_leave(handle)
   end subroutine continues

   !> Histories of all points in the last state of equilibrium iterations
   subroutine histories(handle, points, values, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use sla_continuation, only : path_histories
      use sla_handle, only : model_take, stage_loaded
      use sla_model, only : element_model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: points
      real(c_double), intent(out) :: values(8, points)
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      values = 0.0_c_double
      call model_take(handle, stage_loaded, stage_loaded, model, status)
      if (status /= status_ok) return
      if (points /= model%mesh%points .or. .not. model%path%active) then
         status = status_invalid_argument
      else
         call path_histories(model, values)
      end if
      call handle_leave(handle)
   end subroutine histories

   !> Begin a stage with equilibrium iterations, at the displacements and histories that another ended with
   subroutine go_on(handle, freedoms, nodes, displacement, points, values, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use sla_continuation, only : model_continues, resume_path
      use sla_handle, only : model_take, stage_loaded
      use sla_model, only : element_model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: freedoms            !! of a node
      integer(c_int), intent(in) :: nodes
      real(c_double), intent(in) :: displacement(freedoms, nodes)     !! [m], [rad]
      integer(c_int), intent(in) :: points
      real(c_double), intent(in) :: values(8, points)   !! see histories; none: those of the teeth so far
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      call model_take(handle, stage_loaded, stage_loaded, model, status)
      if (status /= status_ok) return
      status = status_invalid_argument
      if ((points == model%mesh%points .or. points == 0) .and. nodes == model%mesh%nodes .and. &
         freedoms == size(model%mesh%equation, 1) .and. all(abs(values) <= huge(1.0_c_double)) .and. &
         model_continues(model)) then
        call resume_path(model, displacement, values, status)
      end if
      call handle_leave(handle)
   end subroutine go_on

   !> A batch of events
   subroutine run(handle, room, monitors, entries, first, freedom, share, counts, reals, integers, monitored, cracked, &
                  released, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_loaded
      use sla_model, only : element_model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: room
      integer(c_int), intent(in) :: monitors
      integer(c_int), intent(in) :: entries
      integer(c_int), intent(in) :: first(monitors + 1)  !! entry at which each monitor begins
      integer(c_int), intent(in) :: freedom(2, entries)  !! node and which of its freedoms
      real(c_double), intent(in) :: share(entries)
      !> Events, residual checks, re-solutions, new factors, reason (list sla_stop), 1 where equilibrium iterations go
      !> on, linear systems they have solved
      integer(c_int), intent(out) :: counts(7)
      real(c_double), intent(out) :: reals(11, room)      !! see event_log of sla_ledger
      integer(c_int), intent(out) :: integers(4, room)
      real(c_double), intent(out) :: monitored(monitors, room)
      real(c_double), intent(out) :: cracked             !! crack energy, the last event's included [J]
      real(c_double), intent(out) :: released            !! energy lost as motion between steps, see sla_state [J]
      integer(c_int), intent(out) :: status              !! cancelled leaves what was recorded
      type(element_model), pointer :: model
      !f2py threadsafe
      reals = 0.0_c_double
      integers = 0
      monitored = 0.0_c_double
      counts = 0
      cracked = 0.0_c_double
      released = 0.0_c_double
      call model_take(handle, stage_loaded, stage_loaded, model, status)
      if (status /= status_ok) return
      call events(status)
      call handle_leave(handle)

   contains

      subroutine events(fate)
         use common_lists, only : stop_none => sla_stop_none
         use common_status, only : status_bad_index, status_out_of_memory
         use common_threads, only : threads_available
         use sla_continuation, only : run_steps
         use sla_events, only : run_events
         use sla_ledger, only : event_log, log_integers, log_reals
         use sla_handle, only : check_nodes
         use sla_state, only : monitor_set
         integer(c_int), intent(out) :: fate
         type(monitor_set) :: watched
         type(event_log) :: log
         integer(c_int) :: reason
         integer :: k, info
         call check_nodes(model, freedom(1:1, :), 1_c_int, fate)
         if (fate /= status_ok) return
         fate = status_bad_index
         if (any(freedom(2, :) < 1) .or. any(freedom(2, :) > size(model%mesh%equation, 1))) return
         if (first(1) /= 1 .or. first(monitors + 1) /= entries + 1 .or. any(first(2:) < first(:monitors))) return
         fate = status_out_of_memory
         log%count = 0
         allocate (watched%first(monitors + 1), watched%equation(entries), watched%share(entries), &
            watched%ratio(monitors), log%reals(log_reals, room), log%integers(log_integers, room), &
            log%monitors(monitors, room), stat=info)
         if (info /= 0) return
         fate = status_ok
         watched%first(:) = first
         do k = 1, entries
            watched%equation(k) = model%mesh%equation(freedom(2, k), freedom(1, k))
            watched%share(k) = share(k) * model%mesh%factor(freedom(2, k), freedom(1, k))
         end do
         model%threads = threads_available(model%threads)
         reason = stop_none
         ! Where events hand over, the call ends: the caller wants the state of each step
         if (model%path%active) then
            call run_steps(model, watched, log, reason, fate)
         else
            call run_events(model, watched, log, reason, fate)
         end if
         counts = [int(log%count, c_int), int(model%checks%checks, c_int), int(model%checks%solutions, c_int), &
            int(model%checks%factors, c_int), reason, &
            merge(1_c_int, 0_c_int, model%path%active), int(model%path%solutions, c_int)]
         reals(:, 1:log%count) = log%reals(:, 1:log%count)
         integers(:, 1:log%count) = log%integers(:, 1:log%count)
         monitored(:, 1:log%count) = log%monitors(:, 1:log%count)
         cracked = model%ledger%cracked
         released = model%path%released
      end subroutine events

   end subroutine run

   !> One iteration of an incremental analysis at a multiplier, see damage_overloaded
   subroutine relax(handle, lambda, damaged, cracked, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_incremental, only : damage_overloaded
      use sla_handle, only : model_take, stage_loaded
      use sla_model, only : element_model
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: lambda
      integer(c_int), intent(out) :: damaged             !! points that lost a tooth
      real(c_double), intent(out) :: cracked             !! crack energy so far [J]
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      integer :: count
      !f2py threadsafe
      damaged = 0
      cracked = 0.0_c_double
      call model_take(handle, stage_loaded, stage_loaded, model, status)
      if (status /= status_ok) return
      call damage_overloaded(model, lambda, count, status)
      damaged = int(count, c_int)
      cracked = model%ledger%cracked
      call handle_leave(handle)
   end subroutine relax

   !> Displacements of the nodes under A and under B
   subroutine displacement(handle, freedoms, nodes, ua, ub, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use sla_handle, only : model_take, stage_prepared, stage_loaded
      use sla_model, only : element_model, model_displacements
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: freedoms          !! of a node
      integer(c_int), intent(in) :: nodes
      real(c_double), intent(out) :: ua(freedoms, nodes)     !! [m], [rad]
      real(c_double), intent(out) :: ub(freedoms, nodes)     !! [m], [rad]
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      real(c_double), allocatable :: all_a(:), all_b(:)
      integer :: i, k
      ua = 0.0_c_double
      ub = 0.0_c_double
      call model_take(handle, stage_prepared, stage_loaded, model, status)
      if (status /= status_ok) return
      if (nodes /= model%mesh%nodes .or. freedoms /= size(model%mesh%equation, 1)) then
         status = status_invalid_argument
      else
         call model_displacements(model, all_a, all_b, status)
      end if
      do i = 1, merge(nodes, 0_c_int, status == status_ok)
         do k = 1, freedoms
            ua(k, i) = model%mesh%factor(k, i) * all_a(model%mesh%equation(k, i))
            ub(k, i) = model%mesh%factor(k, i) * all_b(model%mesh%equation(k, i))
         end do
      end do
      call handle_leave(handle)
   end subroutine displacement

   !> Residual forces of the present displacements over the loads
   subroutine measure(handle, ratio, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_guard, only : residual
      use sla_handle, only : model_take, stage_loaded
      use sla_model, only : element_model, model_displacements
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(out) :: ratio
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      real(c_double), allocatable :: ua(:), ub(:)
      !f2py threadsafe
      ratio = 0.0_c_double
      call model_take(handle, stage_loaded, stage_loaded, model, status)
      if (status /= status_ok) return
      call model_displacements(model, ua, ub, status)
      if (status == status_ok) then
         call residual(model, ua, ub)
         ratio = model%checks%residual
      end if
      call handle_leave(handle)
   end subroutine measure

   !> State of all points at the multiplier lambda; rows as in sla_plane
   subroutine report(handle, lambda, points, values, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use sla_group, only : point_group
      use sla_handle, only : model_take, stage_prepared, stage_loaded
      use sla_model, only : element_model, model_displacements
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: lambda
      integer(c_int), intent(in) :: points
      real(c_double), intent(out) :: values(19, points)
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      real(c_double), allocatable :: ua(:), ub(:)
      integer :: g
      !f2py threadsafe
      values = 0.0_c_double
      call model_take(handle, stage_prepared, stage_loaded, model, status)
      if (status /= status_ok) return
      if (points /= model%mesh%points) then
         status = status_invalid_argument
      else
         call model_displacements(model, ua, ub, status)
      end if
      if (status == status_ok) then
         do g = 1, size(model%mesh%holders)
            select type (group => model%mesh%holders(g)%group)
            class is (point_group)
               call group%report(ua, ub, lambda, model%search%noise, &
                  values(:, group%offset + 1:group%offset + group%points))
            end select
         end do
      end if
      call handle_leave(handle)
   end subroutine report

   !> Damage of all points, rows as in sla_group
   subroutine damage(handle, points, values, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use sla_handle, only : model_take, stage_new, stage_loaded
      use sla_model, only : element_model, model_damage
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: points
      real(c_double), intent(out) :: values(11, points)
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      values = 0.0_c_double
      call model_take(handle, stage_new, stage_loaded, model, status)
      if (status /= status_ok) return
      if (points /= model%mesh%points) then
         status = status_invalid_argument
      else
         call model_damage(model%mesh, .true., values, status)
      end if
      call handle_leave(handle)
   end subroutine damage

   !> Set the damage of all points; the factor must be made anew
   subroutine set_damage(handle, points, values, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument, status_out_of_memory
      use sla_handle, only : model_take, stage_prepared, stage_loaded
      use sla_model, only : element_model, model_damage
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: points
      real(c_double), intent(in) :: values(11, points)
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      real(c_double), allocatable :: copy(:, :)
      integer :: info
      call model_take(handle, stage_prepared, stage_loaded, model, status)
      if (status /= status_ok) return
      allocate (copy(11, points), stat=info)
      if (info /= 0) then
         status = status_out_of_memory
      else if (points /= model%mesh%points) then
         status = status_invalid_argument
      else
         copy(:, :) = values
         call model_damage(model%mesh, .false., copy, status)
         model%stage = stage_prepared
      end if
      call handle_leave(handle)
   end subroutine set_damage

   !> Read where the event loop stands; its numbers are those of sla_standing
   subroutine standing(handle, values, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_loaded
      use sla_model, only : element_model
      use sla_standing, only : model_standing
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(out) :: values(34)
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      values = 0.0_c_double
      call model_take(handle, stage_loaded, stage_loaded, model, status)
      if (status /= status_ok) return
      values = model_standing(model)
      call handle_leave(handle)
   end subroutine standing

   !> Go on from where an event loop stood, after its loads and damage were set and the factor was made
   subroutine resume(handle, values, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_factored, stage_loaded
      use sla_model, only : element_model
      use sla_standing, only : model_resume
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: values(34)
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      !f2py threadsafe
      call model_take(handle, stage_factored, stage_loaded, model, status)
      if (status /= status_ok) return
      call model_resume(model, values, status)
      if (status == status_ok) model%stage = stage_loaded
      call handle_leave(handle)
   end subroutine resume

end module api_sla

!> Sequentially linear analysis: loads, batches of events and the state of a model of api_sla_model.
!>
!> Nodes, elements and points are 1-based.
module api_sla
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: loads, supports, reactions, run, relax, displacement, measure, report, damage, set_damage, standing, resume

contains

   !> Start a stage; the ledger goes on from `ledger`
   subroutine loads(handle, freedoms, nodes, load_a, load_b, carried, events, ledger, status)
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
      real(c_double), intent(in) :: ledger(3)           !! external, lost, crack energy so far [J]
      integer(c_int), intent(out) :: status
      type(element_model), pointer :: model
      !f2py threadsafe
      call model_take(handle, stage_factored, stage_loaded, model, status)
      if (status /= status_ok) return
      if (nodes /= model%nodes .or. freedoms /= size(model%equation, 1) .or. events < 0) then
         status = status_invalid_argument
      else
         model%events = int(events)
         model%external = ledger(1)
         model%dissipated = ledger(2)
         model%cracked = ledger(3)
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
      if (count /= size(model%moved, 1)) then
         status = status_invalid_argument
      else
         model%moved(:, :) = moved
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
      if (count /= size(model%moved, 1)) then
         status = status_invalid_argument
      else
         force = model%reaction
      end if
      call handle_leave(handle)
   end subroutine reactions

   !> A batch of events
   subroutine run(handle, room, limits, refuse_overload, variant, monitors, entries, first, freedom, share, &
                  counts, reals, integers, monitored, cracked, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_loaded
      use sla_model, only : element_model
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: room
      !> Load carried, displacement of monitor 1 [m], fraction of the peak, compliance over the first, target of
      !> monitor 1 [m], the side it is reached from, loads like B already on, greatest way of monitor 1 [m];
      !> see stop_rules
      real(c_double), intent(in) :: limits(8)
      integer(c_int), intent(in) :: refuse_overload
      !> 1: without equilibrium all loads go down together, 2: what a tooth sets free is put on at the load reached
      integer(c_int), intent(in) :: variant
      integer(c_int), intent(in) :: monitors
      integer(c_int), intent(in) :: entries
      integer(c_int), intent(in) :: first(monitors + 1)  !! entry at which each monitor begins
      integer(c_int), intent(in) :: freedom(2, entries)  !! node and which of its freedoms
      real(c_double), intent(in) :: share(entries)
      !> Events, residual checks, re-solutions, new factors, reason (list sla_stop)
      integer(c_int), intent(out) :: counts(5)
      real(c_double), intent(out) :: reals(11, room)      !! see event_log of sla_ledger
      integer(c_int), intent(out) :: integers(4, room)
      real(c_double), intent(out) :: monitored(monitors, room)
      real(c_double), intent(out) :: cracked             !! crack energy, the last event's included [J]
      integer(c_int), intent(out) :: status              !! cancelled leaves what was recorded
      type(element_model), pointer :: model
      !f2py threadsafe
      reals = 0.0_c_double
      integers = 0
      monitored = 0.0_c_double
      counts = 0
      cracked = 0.0_c_double
      call model_take(handle, stage_loaded, stage_loaded, model, status)
      if (status /= status_ok) return
      call events(status)
      call handle_leave(handle)

   contains

      subroutine events(fate)
         use common_status, only : status_bad_index, status_out_of_memory
         use common_threads, only : threads_available
         use sla_events, only : run_events, stop_rules
         use sla_ledger, only : event_log
         use sla_handle, only : check_nodes
         integer(c_int), intent(out) :: fate
         type(stop_rules) :: rules
         type(event_log) :: log
         integer(c_int), allocatable :: equation(:)
         real(c_double), allocatable :: weight(:)
         integer(c_int) :: reason
         integer :: k, info
         call check_nodes(model, freedom(1:1, :), 1_c_int, fate)
         if (fate /= status_ok) return
         fate = status_bad_index
         if (any(freedom(2, :) < 1) .or. any(freedom(2, :) > size(model%equation, 1))) return
         if (first(1) /= 1 .or. first(monitors + 1) /= entries + 1 .or. any(first(2:) < first(:monitors))) return
         rules = stop_rules(limits(1), limits(2), limits(3), limits(4), refuse_overload /= 0, &
            variant == 1, variant == 2, limits(5), limits(6), limits(7), limits(8))
         fate = status_out_of_memory
         allocate (equation(entries), weight(entries), log%reals(11, room), log%integers(4, room), &
            log%monitors(monitors, room), stat=info)
         if (info /= 0) return
         do k = 1, entries
            equation(k) = model%equation(freedom(2, k), freedom(1, k))
            weight(k) = share(k) * model%factor(freedom(2, k), freedom(1, k))
         end do
         model%threads = threads_available(model%threads)
         call run_events(model, rules, first, equation, weight, log, reason, fate)
         counts = [int(log%count, c_int), int(model%guard, c_int), reason]
         reals(:, 1:log%count) = log%reals(:, 1:log%count)
         integers(:, 1:log%count) = log%integers(:, 1:log%count)
         monitored(:, 1:log%count) = log%monitors(:, 1:log%count)
         cracked = model%cracked
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
      cracked = model%cracked
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
      if (nodes /= model%nodes .or. freedoms /= size(model%equation, 1)) then
         status = status_invalid_argument
      else
         call model_displacements(model, all_a, all_b, status)
      end if
      do i = 1, merge(nodes, 0_c_int, status == status_ok)
         do k = 1, freedoms
            ua(k, i) = model%factor(k, i) * all_a(model%equation(k, i))
            ub(k, i) = model%factor(k, i) * all_b(model%equation(k, i))
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
         ratio = model%residual
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
      if (points /= model%points) then
         status = status_invalid_argument
      else
         call model_displacements(model, ua, ub, status)
      end if
      if (status == status_ok) then
         do g = 1, size(model%holders)
            select type (group => model%holders(g)%group)
            class is (point_group)
               call group%report(ua, ub, lambda, model%noise, &
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
      if (points /= model%points) then
         status = status_invalid_argument
      else
         call model_damage(model, .true., values, status)
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
      else if (points /= model%points) then
         status = status_invalid_argument
      else
         copy(:, :) = values
         call model_damage(model, .false., copy, status)
         model%stage = stage_prepared
      end if
      call handle_leave(handle)
   end subroutine set_damage

   !> Read where the event loop stands; its numbers are those of sla_model
   subroutine standing(handle, values, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use sla_handle, only : model_take, stage_loaded
      use sla_model, only : element_model, model_standing
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
      use sla_model, only : element_model, model_resume
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

!> Where the event loop stands, beside the damage and the loads, as plain numbers: to be read between two batches of
!> events, and to go on from there.
module sla_standing
   use common_kinds, only : wp
   use common_lists, only : sla_event_stick
   use common_status, only : status_ok, status_invalid_argument
   use sla_group, only : point_place
   use sla_mesh, only : is_point
   use sla_model, only : element_model, held_work, load_products, model_recorded, model_solve
   use sla_state, only : energy_ledger, load_work, loop_state, residual_checks
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: model_standing, model_resume, standing_values

   integer, parameter :: standing_values = 34

   !> What the numbers describe
   type :: loop_standing
      type(loop_state) :: loop
      type(energy_ledger) :: ledger
      type(residual_checks) :: checks
      type(point_place) :: upper, lower      !! of the last limits
      real(wp) :: noise = 0.0_wp             !! see limit_search
   end type loop_standing

contains

   !> Read where the loop stands
   function model_standing(model) result(values)
      type(element_model), intent(in) :: model
      real(wp) :: values(standing_values)
      type(loop_standing) :: standing
      standing = loop_standing(model%loop, model%ledger, model%checks, model%search%upper, model%search%lower, &
         model%search%noise)
      call exchange(.true., standing, values)
   end function model_standing

   !> Go on from where an event loop stood, after its loads and its damage were set and the factor made: the
   !> displacements are solved anew, so that all who go on from here get the same bits
   subroutine model_resume(model, values, status)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: values(standing_values)
      integer(c_int), intent(out) :: status      !! invalid_argument: nothing was changed
      type(loop_standing) :: standing
      type(load_work) :: work
      real(wp) :: copy(standing_values)
      status = status_invalid_argument
      if (.not. all(abs([values(1:3), values(17:20), values(24:27)]) <= real(huge(1), wp))) return    ! integers
      standing = loop_standing(model%loop, model%ledger, model%checks, model%search%upper, model%search%lower, &
         model%search%noise)
      copy = values
      call exchange(.false., standing, copy)
      if (.not. (is_point(model%mesh, standing%loop%pending%point_place) .and. is_point(model%mesh, standing%upper) &
         .and. is_point(model%mesh, standing%lower))) return
      if (standing%loop%pending%code < 0 .or. standing%loop%pending%code > sla_event_stick) return
      model%loop = standing%loop
      model%ledger = standing%ledger
      model%checks = standing%checks
      model%search%upper = standing%upper
      model%search%lower = standing%lower
      model%search%noise = standing%noise
      model%loop%event%rank = 0
      model%sliding%active = .false.
      call model_solve(model, status)
      model%sliding%held = held_work(model, model%ledger%lambda)
      call model_recorded(model, model%ledger%lambda, status)
      work = load_products(model)
      model%ledger%work%ba = work%ba
      model%ledger%support_work = model%support%work
   end subroutine model_resume

   !> The numbers in their order, put into `values` or taken from there
   subroutine exchange(store, standing, values)
      logical, intent(in) :: store
      type(loop_standing), intent(inout) :: standing
      real(wp), intent(inout) :: values(standing_values)
      integer :: at
      at = 0
      associate (loop => standing%loop, ledger => standing%ledger, checks => standing%checks)
         call whole(loop%pending%group)
         call whole(loop%pending%point)
         call whole(loop%pending%code)
         call number(loop%lambda)
         call number(standing%noise)
         call number(ledger%work%aa)
         call number(ledger%work%ab)
         call number(ledger%work%bb)
         call number(ledger%external)
         call number(ledger%dissipated)
         call number(ledger%cracked)
         call number(loop%first_compliance)
         call number(loop%peak)
         call number(loop%peak_displacement)
         call number(loop%slope)
         call number(checks%residual)
         call whole(checks%checks)
         call whole(checks%solutions)
         call whole(checks%factors)
         call whole(loop%events)
         call truth(ledger%recorded)
         call truth(ledger%carried)
         call number(ledger%lambda)
         call whole(standing%upper%group)
         call whole(standing%upper%point)
         call whole(standing%lower%group)
         call whole(standing%lower%point)
         call number(loop%scale)
         call number(ledger%scale)
         call number(loop%lambda_held)
         call number(loop%first_constant)
         call number(loop%start_displacement)
         call number(loop%fallen_from)
         call number(loop%furthest)
      end associate

   contains

      subroutine number(item)
         real(wp), intent(inout) :: item
         at = at + 1
         if (store) values(at) = item
         if (.not. store) item = values(at)
      end subroutine number

      subroutine whole(item)
         integer, intent(inout) :: item
         at = at + 1
         if (store) values(at) = real(item, wp)
         if (.not. store) item = nint(values(at))
      end subroutine whole

      subroutine truth(item)
         logical, intent(inout) :: item
         at = at + 1
         if (store) values(at) = merge(1.0_wp, 0.0_wp, item)
         if (.not. store) item = values(at) > 0.5_wp
      end subroutine truth

   end subroutine exchange

end module sla_standing

!> Force release: the forces that a tooth sets free go onto the others at the load reached, before it grows again.
module sla_release
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use sla_group, only : scan_result
   use sla_ledger, only : follow_supports
   use sla_model, only : element_model
   use sla_scan, only : bring_all, choose, scan_way
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: hold_state, set_free

contains

   !> Keep the state in which a tooth is about to pass, from which its forces are set free
   subroutine hold_state(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer :: info
      call bring_all(model, status)
      if (status /= status_ok) return
      model%tree%settled = .false.
      if (.not. allocated(model%from)) then
         allocate (model%from, mold=model%ua, stat=info)
         if (info /= 0) status = status_out_of_memory
         if (info /= 0) return
      end if
      if (model%releasing) then
         model%from(:) = model%from + model%released * (model%ua + model%lambda * model%ub - model%from)
      else
         model%from(:) = model%ua + model%lambda * model%ub
      end if
      model%releasing = .true.
      model%released = 0.0_wp
   end subroutine hold_state

   !> Go the straight way from the state held to that of equilibrium at the load reached, up to the first point that
   !> leaves its strength on it, which is the next to be damaged; model%releasing is false at the end of the way
   subroutine set_free(model, found, status)
      type(element_model), intent(inout) :: model
      type(scan_result), intent(out) :: found
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: way(:)
      real(wp) :: load, excess, total, part
      integer :: g, n, info

      n = model%equations
      call bring_all(model, status)
      if (status /= status_ok) return
      model%tree%settled = .false.
      if (size(model%moved, 1) > 0) call follow_supports(model)
      allocate (way, mold=model%ua, stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      way(:) = model%ua + model%lambda * model%ub - model%from
      call scan_way(model, model%from, way, model%lambda, found)
      part = 1.0_wp
      if (found%empty%point /= 0) then
         part = 0.0_wp
         call choose(model, found%empty)
      else if (found%hi%value < 1.0_wp) then
         part = max(found%hi%value, 0.0_wp)
         call choose(model, found%hi)
      end if
      model%lambda = model%lambda_recorded
      model%released = part
      ! Energy: the loads go on at their value; what is above that of equilibrium is lost on the way
      model%force = 0.0_wp
      do g = 1, size(model%holders)
         call model%holders(g)%group%force(way, model%force)
      end do
      excess = 0.5_wp * dot_product(way(1:n), model%force(1:n))
      load = dot_product(model%fa(1:n) + model%lambda * model%fb(1:n), way(1:n))
      total = model%work_now(1) + model%lambda * (2.0_wp * model%work_now(2) + model%lambda * model%work_now(3))
      model%external = model%external + part * load
      model%dissipated = model%dissipated + excess * (1.0_wp - (1.0_wp - part)**2)
      model%free = [0.5_wp * total - (1.0_wp - part) * load + (1.0_wp - part)**2 * excess, &
         model%support(1, 2) + model%lambda * model%support(2, 2) - &
         (1.0_wp - part) * dot_product(model%force(n + 1:), model%moved(:, 2))]
      model%event%rank = 0
      model%releasing = part < 1.0_wp
      if (model%releasing) return
      model%work = model%work_now
      model%cross = model%work_now(2)
      model%support_was = model%support
   end subroutine set_free

end module sla_release

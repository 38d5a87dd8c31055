!> The admissible range of the load multiplier over all points, and the point that ends it.
!>
!> Regions of the elimination tree that surely cannot hold it are left out (sla_regions); those that are looked at are
!> brought up to date first. The same point for any number of threads.
module sla_scan
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use sla_group, only : below, bound, point_event, point_group, point_place, scan_result, unbounded
   use sla_model, only : element_model
   use sla_regions, only : levels, regions_bring, regions_calm, regions_home, regions_margins, regions_window
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: scan_model, scan_scaled, scan_way, bring_all, crossed, choose_event

   integer, parameter :: few = 100                    !! regions that are looked at sooner by one thread

contains

   !> Limits over all points; regions that cannot hold the least ones are left out. The same for any number of
   !> threads
   subroutine scan_model(model, found, status)
      type(element_model), intent(inout) :: model
      type(scan_result), intent(out) :: found
      integer(c_int), intent(out) :: status
      integer :: k, near, count
      logical :: calm

      found = scan_result()
      associate (search => model%search, tree => model%search%tree, ua => model%solution%ua, ub => model%solution%ub)
         count = size(tree%part)
         if (tree%settled) then
            ! First what is surely concerned, which gives limits to ask the others with.
            if (search%upper%group > 0) search%wanted(element_region(model, search%upper)) = .true.
            if (search%lower%group > 0) search%wanted(element_region(model, search%lower)) = .true.
            call bring_wanted(model, near, status)
            if (status /= status_ok) return
            call scan_list(model, ua, ub, search%noise, guess_limits(model), 1, near, found)
            if (found%hi%value < tree%lambda(levels) .and. found%lo%value > tree%lambda(1) .and. &
                found%hi%value > tree%lambda(1) .and. found%lo%value < tree%lambda(levels)) then
               count = near
               k = size(tree%part)
               do while (k >= 1)
                  if (tree%part(k)%seen /= tree%now) then
                     call regions_calm(tree, k, ua, ub, found%hi%value, found%lo%value, calm)
                     if (calm) then
                        k = tree%part(k)%lowest - 1
                        cycle
                     end if
                     call bring_region(model, k, count, status)
                     if (status /= status_ok) return
                  end if
                  k = k - 1
               end do
               call scan_list(model, ua, ub, search%noise, guess_limits(model), near + 1, count, found)
               call regions_margins(tree, model%mesh%holders, ua, ub)
               return
            end if
         end if
         ! All are brought up to date and looked at, then may wait again.
         call bring_all(model, status)
         if (status /= status_ok) return
         found = scan_result()
         do k = 1, count
            search%list(k) = k
         end do
         call scan_list(model, ua, ub, search%noise, guess_limits(model), 1, count, found)
         tree%settled = tree%measured .and. .not. model%sliding%active
         if (tree%settled) tree%settled = found%hi%value < unbounded .and. found%lo%value > -unbounded
         if (.not. tree%settled) return
         call regions_window(tree, found%hi%value, found%lo%value)
         call regions_margins(tree, model%mesh%holders, ua, ub)
      end associate
   end subroutine scan_model

   !> The point that limits the loads of the last state in equilibrium if all of them grow together from nothing
   subroutine scan_scaled(model, limit, status)
      type(element_model), intent(inout) :: model
      type(bound), intent(out) :: limit              !! share of the loads; point 0 where nothing limits them
      integer(c_int), intent(out) :: status
      type(scan_result) :: found
      real(wp), allocatable :: zero(:), u(:)
      integer :: info

      call bring_all(model, status)
      if (status /= status_ok) return
      model%search%tree%settled = .false.                   ! the margins were those of before
      allocate (zero, u, mold=model%solution%ua, stat=info)
      if (info /= 0) then
         status = status_out_of_memory
         return
      end if
      zero(:) = 0.0_wp
      u(:) = model%solution%ua + model%loop%lambda_held * model%solution%ub
      call scan_way(model, zero, u, model%loop%lambda_held, found)
      if (found%hi%point /= 0) limit = found%hi
   end subroutine scan_scaled

   !> Limits of all points on the straight way u + part way, as those of a multiplier `part`
   subroutine scan_way(model, u, way, load, found)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: u(0:)                  !! [m]
      real(wp), intent(in) :: way(0:)                !! [m]
      real(wp), intent(in) :: load                   !! multiplier that the way is compared with
      type(scan_result), intent(out) :: found
      integer :: k
      do k = 1, size(model%search%list)
         model%search%list(k) = k
      end do
      found = scan_result()
      call scan_list(model, u, way, model%search%noise * max(abs(load), 1.0_wp), scan_result(), 1, &
         size(model%search%list), found)
   end subroutine scan_way

   !> Limits over the listed regions, joined to those found before
   subroutine scan_list(model, ua, ub, noise, near, first, last, found)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: noise
      type(scan_result), intent(in) :: near          !! limits of some points, loosened: they spare others the roots
      integer, intent(in) :: first
      integer, intent(in) :: last
      type(scan_result), intent(inout) :: found
      type(scan_result) :: guess
      integer :: i, k

      guess = near
      call loosen_limits(found, guess)
      !$omp parallel do schedule(static) default(none) &
      !$omp shared(model, ua, ub, noise, guess, first, last) private(i, k) &
      !$omp num_threads(model%threads) if(model%threads > 1 .and. last - first > few)
      do i = first, last
         model%search%part(i) = guess
         associate (part => model%search%tree%part(model%search%list(i)))
            do k = part%run + 1, part%run + part%runs
               select type (group => model%mesh%holders(model%search%tree%run(1, k))%group)
               class is (point_group)
                  call scan_run(group, model%search%tree%run(:, k), ua, ub, model%loop%lambda, noise, &
                     model%search%part(i))
               end select
            end do
         end associate
      end do
      !$omp end parallel do
      do i = first, last
         associate (part => model%search%part(i))
            found%bounded = found%bounded .or. part%bounded
            if (part%hi%point /= 0 .and. takes_place(part%hi, part%hi%value, found%hi, &
               found%hi%value)) found%hi = part%hi
            if (part%lo%point /= 0 .and. takes_place(part%lo, -part%lo%value, found%lo, &
               -found%lo%value)) found%lo = part%lo
            if (part%empty%point == 0) cycle
            if (found%empty%point == 0 .or. part%empty%value > found%empty%value .or. &
                (.not. part%empty%value < found%empty%value .and. earlier(part%empty, found%empty))) then
               found%empty = part%empty
            end if
         end associate
      end do
   end subroutine scan_list

   !> Limits over one run of elements; what it finds carries the group's number
   subroutine scan_run(group, run, ua, ub, lambda, noise, found)
      class(point_group), intent(in) :: group
      integer, intent(in) :: run(3)          !! group, first and last element
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      type(scan_result), intent(inout) :: found
      type(scan_result) :: new
      new = found
      call group%scan(run(2), run(3), ua, ub, lambda, noise, new)
      ! The group gives new limits no number.
      if (new%hi%group == 0 .and. new%hi%point /= 0) new%hi%group = run(1)
      if (new%lo%group == 0 .and. new%lo%point /= 0) new%lo%group = run(1)
      if (new%empty%group == 0 .and. new%empty%point /= 0) new%empty%group = run(1)
      found = new
   end subroutine scan_run

   !> Does a limit take the place of another one: it is less, or the same of an earlier point
   pure function takes_place(new, value, old, least) result(better)
      type(bound), intent(in) :: new
      real(wp), intent(in) :: value          !! of the new, the least wins
      type(bound), intent(in) :: old
      real(wp), intent(in) :: least          !! of the old
      logical :: better
      better = below(value, least)
      if (.not. better .and. old%point /= 0 .and. .not. below(least, value)) better = earlier(new, old)
   end function takes_place

   !> Does a point come before another
   pure function earlier(a, b) result(first)
      type(bound), intent(in) :: a, b
      logical :: first
      first = a%group < b%group .or. (a%group == b%group .and. a%point < b%point)
   end function earlier

   !> Loosened limits of the points that set the last ones: those of the point damaged last are near the new ones
   function guess_limits(model) result(guess)
      type(element_model), intent(in) :: model
      type(scan_result) :: guess

      guess = scan_result()
      call join_limits(model%search%upper)
      call join_limits(model%search%lower)

   contains

      subroutine join_limits(place)
         type(point_place), intent(in) :: place
         type(scan_result) :: found
         integer :: e
         if (place%group == 0) return
         select type (group => model%mesh%holders(place%group)%group)
         class is (point_group)
            e = 1 + (place%point - 1) / (group%points / group%elements)
            found = scan_result()
            call group%scan(e, e, model%solution%ua, model%solution%ub, model%loop%lambda, model%search%noise, found)
            call loosen_limits(found, guess)
         end select
      end subroutine join_limits

   end function guess_limits

   !> Limits that leave room for equals of those found
   pure subroutine loosen_limits(found, guess)
      type(scan_result), intent(in) :: found
      type(scan_result), intent(inout) :: guess
      real(wp), parameter :: room = 1.0e-9_wp
      if (found%hi%point /= 0) guess%hi%value = min(guess%hi%value, found%hi%value + &
         max(room * abs(found%hi%value), tiny(room)))
      if (found%lo%point /= 0) guess%lo%value = max(guess%lo%value, found%lo%value - &
         max(room * abs(found%lo%value), tiny(room)))
   end subroutine loosen_limits

   !> Do the limits leave no multiplier, by more than rounding? A joint that closes at zero stress would open again at
   !> the same load, then close, many times over.
   pure function crossed(found) result(yes)
      type(scan_result), intent(in) :: found
      logical :: yes
      real(wp), parameter :: rounding = 1.0e-9_wp
      yes = found%hi%value < found%lo%value
      if (yes .and. found%hi%value < unbounded .and. found%lo%value > -unbounded) yes = &
         found%lo%value - found%hi%value > rounding * max(abs(found%hi%value), abs(found%lo%value))
   end function crossed

   !> The point to damage next and its multiplier
   pure subroutine choose_event(model, chosen)
      type(element_model), intent(inout) :: model
      type(bound), intent(in) :: chosen
      model%loop%pending = point_event(chosen%group, chosen%point, chosen%code)
      model%loop%lambda = chosen%value
   end subroutine choose_event

   !> The region of the first freedom of a point's element
   pure function element_region(model, place) result(k)
      type(element_model), intent(in) :: model
      type(point_place), intent(in) :: place
      integer :: k
      k = size(model%search%tree%part)
      select type (group => model%mesh%holders(place%group)%group)
      class is (point_group)
         k = regions_home(model%search%tree, group%equation(:, 1 + (place%point - 1) / (group%points / group%elements)))
      end select
   end function element_region

   !> Bring the wanted regions and those above them up to date, unless they are; all that are go to the list
   subroutine bring_wanted(model, count, status)
      type(element_model), intent(inout) :: model
      integer, intent(out) :: count
      integer(c_int), intent(out) :: status
      integer :: k
      status = status_ok
      count = 0
      associate (tree => model%search%tree)
         do k = 1, size(tree%part)
            if (.not. model%search%wanted(k) .and. tree%part(k)%seen /= tree%now) cycle
            if (tree%part(k)%parent > 0) model%search%wanted(tree%part(k)%parent) = .true.
         end do
         do k = size(tree%part), 1, -1
            if (tree%part(k)%seen == tree%now) then
               count = count + 1
               model%search%list(count) = k
            else if (model%search%wanted(k)) then
               call bring_region(model, k, count, status)
               if (status /= status_ok) return
            end if
         end do
         model%search%wanted(:) = model%search%watched
      end associate
   end subroutine bring_wanted

   !> Bring one region up to date and put it on the list
   subroutine bring_region(model, k, count, status)
      type(element_model), intent(inout) :: model
      integer, intent(in) :: k
      integer, intent(inout) :: count
      integer(c_int), intent(out) :: status
      call regions_bring(model%search%tree, k, model%stiffness%factor, .false., model%solution%ua, model%solution%ub, &
         model%solution%z, status)
      count = count + 1
      model%search%list(count) = k
   end subroutine bring_region

   !> Bring all regions up to date
   subroutine bring_all(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer :: k, count
      status = status_ok
      count = 0
      do k = size(model%search%tree%part), 1, -1
         if (model%search%tree%part(k)%seen /= model%search%tree%now) call bring_region(model, k, count, status)
         if (status /= status_ok) return
      end do
      model%search%tree%part(:)%patience = 0
      model%search%tree%part(:)%failed = 0
   end subroutine bring_all

end module sla_scan
